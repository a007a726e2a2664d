// SPDX-License-Identifier: Apache-2.0
//
// A face as seven linear forms, from which the distance of any point is computed without a branch.
// The same source, with the same bits, is used on the CPU and on a GPU.
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/Lattice.h"
#include "tetvdb/geometry/NearestDouble.h"
#include "tetvdb/geometry/Ownership.h"
#include "tetvdb/geometry/VectorMath.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace tetvdb {

/// Value of a linear form at p.
struct LinearForm {
  Vec3d slope{0, 0, 0};
  double constant = 0;
  TETVDB_HD double operator()(const Vec3d& p) const { return dot(slope, p) + constant; }
  /// Largest difference from the value at the centre of a cube with this half side.
  TETVDB_HD double swing(double half) const {
    return half * (std::abs(slope[0]) + std::abs(slope[1]) + std::abs(slope[2]));
  }
};

/// A triangle, lengths in voxels relative to some voxel. With s the height above its plane, q_k the
/// distance outside edge k within the plane, and e_k the distance beyond the end points of that
/// edge, the squared distance is s^2 if all q_k < 0, and else s^2 + the minimum of q_k^2 + e_k^2.
struct FaceFrame {
  LinearForm height;
  std::array<LinearForm, 3> beyond; ///< q_k
  std::array<LinearForm, 3> along;  ///< from the edge's first point; its second is at `length`
  std::array<double, 3> length{};
  Vec3d low{}, high{}; ///< box
};

/// Swaps corners p and q into the order of their positions.
TETVDB_HD inline void orderCorners(LatticePoint& p, LatticePoint& q) {
  const bool before = q.x != p.x ? q.x < p.x : q.y != p.y ? q.y < p.y : q.z < p.z;
  if (!before)
    return;
  const LatticePoint t = p;
  p = q;
  q = t;
}

/// The linear form with this slope that is 0 at p.
TETVDB_HD inline LinearForm formThrough(const Vec3d& slope, const Vec3d& p) {
  return LinearForm{slope, -dot(slope, p)};
}

/// A segment: an edge with an outside on both sides.
TETVDB_HD inline void frameSegment(const Vec3d& from, const Vec3d& to, FaceFrame& frame) {
  const Vec3d edge = minus(to, from);
  const double length = std::sqrt(dot(edge, edge));
  const Vec3d direction = length > 0 ? times(edge, 1 / length) : Vec3d{1, 0, 0};
  std::size_t min = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(direction[k]) < std::abs(direction[min]))
      min = k;
  Vec3d other{0, 0, 0};
  other[min] = 1;
  Vec3d side = cross(direction, other);
  side = times(side, 1 / std::sqrt(dot(side, side)));
  frame.height = formThrough(cross(direction, side), from);
  for (std::size_t k = 0; k < 3; ++k) {
    frame.along[k] = formThrough(direction, from);
    frame.length[k] = length;
    frame.beyond[k] = formThrough(k == 1 ? times(side, -1) : side, from);
  }
}

/// The frame of a, b, c relative to voxel `origin`. The corners are used in order of position: the
/// frame does not depend on their order.
TETVDB_HD inline FaceFrame faceFrame(LatticePoint a, LatticePoint b, LatticePoint c,
                                     const Vec3d& origin) {
  orderCorners(a, b);
  orderCorners(b, c);
  orderCorners(a, b);
  const auto seen = [&origin](const LatticePoint& p) {
    constexpr auto unit = static_cast<double>(kUnitsPerVoxel);
    return Vec3d{(p.x - origin[0] * unit) * kVoxelsPerUnit,
                 (p.y - origin[1] * unit) * kVoxelsPerUnit,
                 (p.z - origin[2] * unit) * kVoxelsPerUnit};
  };
  const Vec3d corners[3] = {seen(a), seen(b), seen(c)};
  FaceFrame frame;
  frame.low = frame.high = corners[0];
  for (std::size_t i = 1; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const double p = corners[i][k];
      frame.low[k] = p < frame.low[k] ? p : frame.low[k];
      frame.high[k] = p > frame.high[k] ? p : frame.high[k];
    }

  // Exact before rounding: slivers would lose it.
  const ExactVector exact = triangleNormal(a, b, c);
  Vec3d normal{nearestDouble(exact.x), nearestDouble(exact.y), nearestDouble(exact.z)};
  const double area = std::sqrt(dot(normal, normal));
  if (!(area > 0)) {
    frameSegment(corners[0], corners[2], frame);
    return frame;
  }
  normal = times(normal, 1 / area);
  frame.height = formThrough(normal, corners[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &from = corners[k], &to = corners[k == 2 ? 0 : k + 1];
    const Vec3d edge = minus(to, from);
    frame.length[k] = std::sqrt(dot(edge, edge));
    const Vec3d direction = times(edge, 1 / frame.length[k]);
    frame.along[k] = formThrough(direction, from);
    frame.beyond[k] = formThrough(cross(direction, normal), from);
  }
  return frame;
}

} // namespace tetvdb
