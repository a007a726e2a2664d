// SPDX-License-Identifier: Apache-2.0
//
// A face as seven linear forms, from which the distance of any point follows without a branch.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/Lattice.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/voxelize/Ownership.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace tetvdb {

/// Value of a linear form at p.
struct LinearForm {
  Vec3d slope{0, 0, 0};
  double constant = 0;
  double operator()(const Vec3d& p) const { return dot(slope, p) + constant; }
  /// Largest difference from the value in the middle of a cube, for half a side.
  double swing(double half) const {
    return half * (std::abs(slope[0]) + std::abs(slope[1]) + std::abs(slope[2]));
  }
};

/// A triangle, lengths in voxels relative to some voxel. With s the height above its plane, q_k how
/// far outside edge k a point is within the plane, and e_k how far beyond the ends of that edge,
/// the squared distance is s^2 where all q_k < 0, and else s^2 + the least q_k^2 + e_k^2.
struct FaceFrame {
  LinearForm height;
  std::array<LinearForm, 3> beyond; ///< q_k
  std::array<LinearForm, 3> along;  ///< from the edge's start; its end is at `length`
  std::array<double, 3> length{};
  Vec3d low{}, high{}; ///< box
};

/// The frame of a, b, c seen from voxel `origin`. The corners are taken in order of position: the
/// frame is the same for any order of them.
inline FaceFrame faceFrame(LatticePoint a, LatticePoint b, LatticePoint c, const Vec3d& origin) {
  const auto before = [](const LatticePoint& p, const LatticePoint& q) {
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  };
  if (before(b, a))
    std::swap(a, b);
  if (before(c, b))
    std::swap(b, c);
  if (before(b, a))
    std::swap(a, b);
  const auto seen = [&](const LatticePoint& p) {
    constexpr auto unit = static_cast<double>(kUnitsPerVoxel);
    return Vec3d{(p.x - origin[0] * unit) * kVoxelsPerUnit,
                 (p.y - origin[1] * unit) * kVoxelsPerUnit,
                 (p.z - origin[2] * unit) * kVoxelsPerUnit};
  };
  const auto through = [](const Vec3d& slope, const Vec3d& p) {
    return LinearForm{slope, -dot(slope, p)};
  };
  const Vec3d corners[3] = {seen(a), seen(b), seen(c)};
  FaceFrame frame;
  for (std::size_t k = 0; k < 3; ++k) {
    frame.low[k] = std::min({corners[0][k], corners[1][k], corners[2][k]});
    frame.high[k] = std::max({corners[0][k], corners[1][k], corners[2][k]});
  }

  // Exact before it is rounded: slivers would lose it.
  const ExactVector exact = triangleNormal(a, b, c);
  Vec3d normal{static_cast<double>(exact.x), static_cast<double>(exact.y),
               static_cast<double>(exact.z)};
  const double area = std::sqrt(dot(normal, normal));
  if (area > 0) {
    normal = times(normal, 1 / area);
    frame.height = through(normal, corners[0]);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d &from = corners[k], &to = corners[(k + 1) % 3];
      const Vec3d edge = minus(to, from);
      frame.length[k] = std::sqrt(dot(edge, edge));
      const Vec3d direction = times(edge, 1 / frame.length[k]);
      frame.along[k] = through(direction, from);
      frame.beyond[k] = through(cross(direction, normal), from);
    }
    return frame;
  }
  // A segment from the first corner to the last: an edge with an outside on either side of it.
  const Vec3d edge = minus(corners[2], corners[0]);
  const double length = std::sqrt(dot(edge, edge));
  const Vec3d direction = length > 0 ? times(edge, 1 / length) : Vec3d{1, 0, 0};
  const std::size_t least = static_cast<std::size_t>(
      std::min_element(direction.begin(), direction.end(),
                       [](double p, double q) { return std::abs(p) < std::abs(q); }) -
      direction.begin());
  Vec3d other{0, 0, 0};
  other[least] = 1;
  Vec3d side = cross(direction, other);
  side = times(side, 1 / std::sqrt(dot(side, side)));
  frame.height = through(cross(direction, side), corners[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    frame.along[k] = through(direction, corners[0]);
    frame.length[k] = length;
    frame.beyond[k] = through(k == 1 ? times(side, -1) : side, corners[0]);
  }
  return frame;
}

} // namespace tetvdb
