// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/SmoothPoints.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/PlacePoint.h"

namespace tetvdb {
namespace {

// A move has to reduce the sum by this factor.
constexpr double kGain = 0.98;
// How far points of the surface may leave the input, as a share of the radius: a point at the
// border of the envelope can hardly move any more.
constexpr double kReach = 0.3;
// How often a move that leaves the bounds is halved.
constexpr int kHalvings = 3;
// Points of more tets are skipped: they take long.
constexpr std::size_t kManyTets = 300;

} // namespace

std::size_t PointSmoother::sweep() {
  std::size_t moves = 0;
  for (std::uint32_t p = 0; p < complex_.points.size(); ++p) {
    const TetComplex::Point& point = complex_.points[p];
    if (point.exists() && !point.fixed && (point.changed & kChanged))
      moves += smooth(p);
  }
  return moves;
}

bool PointSmoother::smooth(std::uint32_t point) {
  const auto settle = [&] {
    complex_.points[point].clearChanged(kChanged);
    return false;
  };
  star_.gather(complex_, point);
  if (star_.worstEnergy() <= energy_ || star_.tets().size() > kManyTets)
    return settle();
  onBoundary_ = complex_.points[point].onBoundary;
  if (onBoundary_) {
    std::size_t found = 0;
    for (const PointStar::Spoke& spoke : star_.spokes())
      if (spoke.sheets == 1) {
        if (found == 2)
          return settle();
        boundaryNeighbours_[found++] = spoke.point;
      }
    if (found != 2 || bounds_.boundary.empty())
      return settle();
  }
  ++tried_;
  const double worst = star_.worstEnergy();
  const double limit = worst * worst * worst * (1 + 1e-6);
  const double before = sumOfCubes(star_.faces(), complex_.at(point), limit);
  // A point of the surface moves on the input; where that does not help, anywhere within bounds.
  const bool mayLeave = star_.onSurface() && !onBoundary_;
  Vec3d at;
  const double reach = kReach * bounds_.radius;
  const auto moves = [&](bool isBound) {
    at = complex_.at(point);
    const double now = descend(star_.faces(), limit, before, at,
                               [&](Vec3d& trial) { project(trial, isBound ? 0 : reach); });
    if (!(now < kGain * before))
      return false;
    // Halfway the sum is smaller than here too: it is convex.
    for (int halving = 0; halving < kHalvings; ++halving) {
      if (keepsBounds(at))
        return true;
      at = roundToLattice(times(plus(at, complex_.at(point)), 0.5));
      project(at, isBound ? 0 : reach);
      if (!(sumOfCubes(star_.faces(), at, limit) < kGain * before))
        return false;
    }
    return false;
  };
  if (!moves(true) && !(mayLeave && worst > freeEnergy_ && moves(false)))
    return settle();
  complex_.move(point, at, star_.tets());
  return true;
}

// Onto the boundary edges, or to within `reach` of the surface, where the point is on one.
void PointSmoother::project(Vec3d& at, double reach) const {
  if (onBoundary_)
    at = roundToLattice(bounds_.boundary.nearest(at).point);
  if (onBoundary_ || !star_.onSurface())
    return;
  const Envelope::Nearest nearest = bounds_.surface.nearest(at);
  if (nearest.distance > reach)
    at = roundToLattice(
        plus(nearest.point, times(minus(at, nearest.point), reach / nearest.distance)));
}

bool PointSmoother::keepsBounds(const Vec3d& at) {
  if (onBoundary_)
    for (const std::uint32_t neighbour : boundaryNeighbours_)
      if (!bounds_.boundary.contains(at, complex_.at(neighbour), bounds_.radius))
        return false;
  return !star_.onSurface() || guard_.allows(complex_, star_, at);
}

} // namespace tetvdb
