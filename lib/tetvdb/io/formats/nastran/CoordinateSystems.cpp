// SPDX-License-Identifier: Apache-2.0
//
// MSC Nastran Quick Reference Guide, CORD1R to CORD2S.
#include "tetvdb/io/formats/nastran/CoordinateSystems.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/geometry/VectorMath.h"

#include <cmath>

namespace tetvdb {
namespace {

Vec3d rectangular(CoordinateKind kind, const Vec3d& p) {
  const double first = p[1] * kRadiansPerDegree, second = p[2] * kRadiansPerDegree;
  switch (kind) {
  case CoordinateKind::Rectangular:
    return p;
  case CoordinateKind::Cylindrical:
    return {p[0] * std::cos(first), p[0] * std::sin(first), p[2]};
  case CoordinateKind::Spherical:
    return {p[0] * std::sin(first) * std::cos(second), p[0] * std::sin(first) * std::sin(second),
            p[0] * std::cos(first)};
  }
  return p;
}

} // namespace

std::optional<Vec3d> CoordinateSystems::toBasic(std::int64_t system, const Vec3d& position,
                                                const GridPosition& gridPosition) {
  if (system == 0)
    return position;
  const auto found = systems_.find(system);
  const Frame* const frame =
      found == systems_.end() ? nullptr : frameOf(found->second, gridPosition);
  if (frame == nullptr)
    return {};
  const Vec3d p = rectangular(found->second.system.kind, position);
  Vec3d sum = frame->origin;
  for (std::size_t k = 0; k < 3; ++k)
    sum = plus(sum, times(frame->axes[k], p[k]));
  return sum;
}

const CoordinateSystems::Frame* CoordinateSystems::frameOf(Entry& entry,
                                                           const GridPosition& gridPosition) {
  if (entry.frame)
    return &*entry.frame;
  constexpr int deepest = 200; // reached also by a system that is defined by itself
  if (depth_ >= deepest)
    return nullptr;
  ++depth_;
  std::array<Vec3d, 3> points{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto point = entry.system.grids[k] != 0
                           ? gridPosition(entry.system.grids[k])
                           : toBasic(entry.system.reference, entry.system.points[k], gridPosition);
    if (!point)
      return nullptr;
    points[k] = *point;
  }
  --depth_;
  const Vec3d axis = minus(points[1], points[0]);
  const Vec3d across = cross(axis, minus(points[2], points[0])); // along y
  if (!(length(axis) > 0) || !(length(across) > 0))
    return nullptr;
  const Vec3d z = times(axis, 1 / length(axis)), y = times(across, 1 / length(across));
  entry.frame = Frame{points[0], {cross(y, z), y, z}};
  return &*entry.frame;
}

} // namespace tetvdb
