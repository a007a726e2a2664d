// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/SmoothPoints.h"

#include "tetvdb/tetrahedralize/PlacePoint.h"

namespace tetvdb {
namespace {

// A move that gains less is not worth it.
constexpr double kGain = 0.98;
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
  Vec3d at = complex_.at(point);
  const double worst = star_.worstEnergy();
  const double limit = worst * worst * worst * (1 + 1e-6);
  const double before = sumOfCubes(star_.faces(), at, limit);
  const double now =
      descend(star_.faces(), limit, before, at, [this](Vec3d& trial) { project(trial); });
  if (!(now < kGain * before) || !keepsBounds(at))
    return settle();
  complex_.move(point, at, star_.tets());
  return true;
}

// Onto the rim or the surface, where the point is on one.
void PointSmoother::project(Vec3d& at) const {
  if (onRim_)
    at = roundToLattice(bounds_.rim.nearest(at).point);
  else if (star_.onSurface())
    at = roundToLattice(bounds_.surface.nearest(at).point);
}

bool PointSmoother::keepsBounds(const Vec3d& at) {
  if (onRim_)
    for (const std::uint32_t end : rim_)
      if (!bounds_.rim.contains(at, complex_.at(end), bounds_.radius))
        return false;
  return !star_.onSurface() || guard_.allows(complex_, star_, at);
}

} // namespace tetvdb
