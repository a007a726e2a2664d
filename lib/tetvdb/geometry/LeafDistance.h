// SPDX-License-Identifier: Apache-2.0
//
// Squared distances from the voxel centres of a leaf to a face, and the leaves and rows of voxels
// within reach. The same source, with the same bits, is used on the CPU and on a GPU.
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/FaceFrame.h"
#include "tetvdb/geometry/NodeIndex.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tetvdb {

constexpr int kLeavesAlong = kNodeSize / kLeafSize;
constexpr int kLeavesInNode = kLeavesAlong * kLeavesAlong * kLeavesAlong;
constexpr int kRowsInLeaf = kLeafSize * kLeafSize;
constexpr int kVoxelsInLeaf = kRowsInLeaf * kLeafSize;

// From the centre of a leaf to its outermost voxel centres.
constexpr double kHalfLeaf = 0.5 * (kLeafSize - 1);
constexpr double kHalfNode = 0.5 * (kNodeSize - 1);

constexpr double kBoundSlack = 1e-6; ///< above the error of bounds in doubles
constexpr double kReachSlack = 1e-5; ///< the same for the single precision of rows

/// First voxel of a node.
TETVDB_HD inline Vec3d firstVoxelOf(const NodeIndex& node) {
  return {static_cast<double>(node[0]) * kNodeSize, static_cast<double>(node[1]) * kNodeSize,
          static_cast<double>(node[2]) * kNodeSize};
}

/// Whether the centre of a cube, half a side away from its outermost voxel centres, permits some of
/// them to be within the radius.
TETVDB_HD inline bool mayReach(const FaceFrame& face, const Vec3d& midpoint, double half,
                               double radius) {
  if (std::abs(face.height(midpoint)) > radius + face.height.swing(half) + kBoundSlack)
    return false;
  for (std::size_t k = 0; k < 3; ++k)
    if (face.beyond[k](midpoint) > radius + face.beyond[k].swing(half) + kBoundSlack)
      return false;
  return true;
}

/// Calls visit(leaf) for the leaves of a node that may have voxels within the radius of a face
/// relative to the node's first voxel: positions (x * 16 + y) * 16 + z in leaves, ascending.
template <typename Visit>
TETVDB_HD inline void forLeavesNear(const FaceFrame& face, double radius, const Visit& visit) {
  int low[3], high[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const double first = std::ceil(face.low[k] - radius), last = std::floor(face.high[k] + radius);
    low[k] = static_cast<int>(first < 0 ? 0 : first) / kLeafSize;
    high[k] = last < 0 ? -1 : static_cast<int>(last > kNodeSize - 1 ? kNodeSize - 1 : last);
    high[k] = high[k] < 0 ? -1 : high[k] / kLeafSize;
  }
  for (int x = low[0]; x <= high[0]; ++x)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int z = low[2]; z <= high[2]; ++z) {
        const Vec3d midpoint{x * kLeafSize + kHalfLeaf, y * kLeafSize + kHalfLeaf,
                             z * kLeafSize + kHalfLeaf};
        if (mayReach(face, midpoint, kHalfLeaf, radius))
          visit((x * kLeavesAlong + y) * kLeavesAlong + z);
      }
}

/// A form in single precision, relative to the centre of a leaf.
struct LeafForm {
  float x, y, z, midpoint;

  LeafForm() = default;
  TETVDB_HD LeafForm(const LinearForm& form, const Vec3d& at)
      : x(static_cast<float>(form.slope[0])), y(static_cast<float>(form.slope[1])),
        z(static_cast<float>(form.slope[2])), midpoint(static_cast<float>(form(at))) {}
  template <typename Number>
  TETVDB_HD TETVDB_INLINE Number row(Number dx, Number dy) const {
    return midpoint + (x * dx + y * dy);
  }
  TETVDB_HD TETVDB_INLINE float swingZ() const {
    return static_cast<float>(kHalfLeaf) * (z < 0 ? -z : z);
  }
};

/// A face relative to a leaf: all relevant lengths are within a few voxels of the leaf's centre, so
/// that the error of single precision is below 3e-6 voxels.
struct LeafFace {
  LeafForm height, beyond[3], along[3];
  float past[3];      ///< along at the edge's second point, relative to the centre
  int x0, x1, y0, y1; ///< rows within the radius, inclusive
};

/// `leaf`: its position in the node, for a face relative to the node's first voxel.
TETVDB_HD inline LeafFace seenFrom(const FaceFrame& face, int leaf, double radius) {
  const int position[3] = {leaf / (kLeavesAlong * kLeavesAlong), leaf / kLeavesAlong % kLeavesAlong,
                           leaf % kLeavesAlong};
  const Vec3d midpoint{position[0] * kLeafSize + kHalfLeaf, position[1] * kLeafSize + kHalfLeaf,
                       position[2] * kLeafSize + kHalfLeaf};
  LeafFace seen;
  seen.height = LeafForm(face.height, midpoint);
  for (std::size_t k = 0; k < 3; ++k) {
    seen.beyond[k] = LeafForm(face.beyond[k], midpoint);
    seen.along[k] = LeafForm(face.along[k], midpoint);
    seen.past[k] = static_cast<float>(face.along[k](midpoint) - face.length[k]);
  }
  const auto first = [&](std::size_t axis) {
    const double low = std::ceil(face.low[axis] - radius - position[axis] * kLeafSize);
    return static_cast<int>(low < 0 ? 0 : low);
  };
  const auto last = [&](std::size_t axis) {
    const double high = std::floor(face.high[axis] + radius - position[axis] * kLeafSize);
    return static_cast<int>(high > kLeafSize - 1 ? kLeafSize - 1 : high);
  };
  seen.x0 = first(0);
  seen.x1 = last(0);
  seen.y0 = first(1);
  seen.y1 = last(1);
  return seen;
}

/// The terms of a face's forms that are constant along a row of voxels; of several rows if Number
/// is a vector.
template <typename Number>
struct FaceRow {
  Number height, beyond[3], along[3];
};

/// The row at dx, dy relative to the leaf's centre.
template <typename Number>
TETVDB_HD TETVDB_INLINE FaceRow<Number> rowAt(const LeafFace& face, Number dx, Number dy) {
  FaceRow<Number> row;
  row.height = face.height.row(dx, dy);
  for (int k = 0; k < 3; ++k) {
    row.beyond[k] = face.beyond[k].row(dx, dy);
    row.along[k] = face.along[k].x * dx + face.along[k].y * dy;
  }
  return row;
}

/// Row (x, y) of a face's leaf; returns whether its voxels may be within `reach`, the radius plus
/// kReachSlack.
TETVDB_HD TETVDB_INLINE bool rowOf(const LeafFace& face, int x, int y, float reach,
                                   FaceRow<float>& row) {
  const float dx = static_cast<float>(x) - 3.5f, dy = static_cast<float>(y) - 3.5f;
  row.height = face.height.row(dx, dy);
  if ((row.height < 0 ? -row.height : row.height) > reach + face.height.swingZ())
    return false;
  for (int k = 0; k < 3; ++k) {
    row.beyond[k] = face.beyond[k].row(dx, dy);
    if (row.beyond[k] > reach + face.beyond[k].swingZ())
      return false;
  }
  for (int k = 0; k < 3; ++k)
    row.along[k] = face.along[k].x * dx + face.along[k].y * dy;
  return true;
}

template <typename Number>
TETVDB_HD TETVDB_INLINE Number largerOf(Number a, Number b) {
  return a > b ? a : b;
}
template <typename Number>
TETVDB_HD TETVDB_INLINE Number smallerOf(Number a, Number b) {
  return a < b ? a : b;
}

/// Squared distance of the row's voxel at `z` relative to the leaf's centre; of several if Number
/// is a vector.
template <typename Row, typename Number>
TETVDB_HD TETVDB_INLINE Number squaredDistance(const LeafFace& face, const FaceRow<Row>& row,
                                               Number z) {
  const Number zero = z - z;
  const auto edge = [&](int k, Number q) {
    const Number uz = row.along[k] + face.along[k].z * z;
    const Number e = largerOf(largerOf(uz + face.past[k], -(uz + face.along[k].midpoint)), zero);
    return q * q + e * e;
  };
  const Number b0 = row.beyond[0] + face.beyond[0].z * z, b1 = row.beyond[1] + face.beyond[1].z * z,
               b2 = row.beyond[2] + face.beyond[2].z * z;
  const Number nearest = smallerOf(smallerOf(edge(0, b0), edge(1, b1)), edge(2, b2));
  const Number outside = largerOf(largerOf(b0, b1), b2);
  const Number s = row.height + face.height.z * z;
  return s * s + (outside < zero ? zero : nearest);
}

} // namespace tetvdb
