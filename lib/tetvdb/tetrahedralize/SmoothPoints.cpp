// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/SmoothPoints.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/PlacePoint.h"

namespace tetvdb {
namespace {

// A move that gains less is not worth it.
constexpr double kGain = 0.98;
// So far in the radius points of the surface may go off the input: who is at the border of the
// envelope hardly moves any more.
constexpr double kReach = 0.3;
// How often a move that leaves the bounds is halved.
constexpr int kHalvings = 3;
// Points of more tets take long and do not matter more than others.
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
    std::uint8_t& changed = complex_.points[point].changed;
    changed = static_cast<std::uint8_t>(changed & ~kChanged);
    return false;
  };
  star_.gather(complex_, point);
  if (star_.worstEnergy() <= energy_ || star_.tets().size() > kManyTets)
    return settle();
  onRim_ = complex_.points[point].rim;
  if (onRim_) {
    std::size_t ends = 0;
    for (const PointStar::Spoke& spoke : star_.spokes())
      if (spoke.sheets == 1) {
        if (ends == 2)
          return settle();
        rim_[ends++] = spoke.point;
      }
    if (ends != 2 || bounds_.rim.empty())
      return settle();
  }
  ++tried_;
  const double worst = star_.worstEnergy();
  const double limit = worst * worst * worst * (1 + 1e-6);
  const double before = sumOfCubes(star_.faces(), complex_.at(point), limit);
  // A point of the surface goes along the input; where that does not help, anywhere within bounds.
  const bool mayLeave = star_.onSurface() && !onRim_;
  Vec3d at;
  const double reach = kReach * bounds_.radius;
  const auto moves = [&](bool isBound) {
    at = complex_.at(point);
    const double now = descend(star_.faces(), limit, before, at,
                               [&](Vec3d& trial) { project(trial, isBound ? 0 : reach); });
    if (!(now < kGain * before))
      return false;
    // On the way there it is better than here too.
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

// Onto the rim or as near as that to the surface, where the point is on one.
void PointSmoother::project(Vec3d& at, double reach) const {
  if (onRim_)
    at = roundToLattice(bounds_.rim.nearest(at).point);
  if (onRim_ || !star_.onSurface())
    return;
  const Envelope::Nearest nearest = bounds_.surface.nearest(at);
  if (nearest.distance > reach)
    at = roundToLattice(
        plus(nearest.point, times(minus(at, nearest.point), reach / nearest.distance)));
}

bool PointSmoother::keepsBounds(const Vec3d& at) {
  if (onRim_)
    for (const std::uint32_t end : rim_)
      if (!bounds_.rim.contains(at, complex_.at(end), bounds_.radius))
        return false;
  return !star_.onSurface() || guard_.allows(complex_, star_, at);
}

} // namespace tetvdb
