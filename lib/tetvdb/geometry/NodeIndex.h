// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstdint>

namespace tetvdb {

constexpr int kLeafSize = 8;         ///< voxels along a leaf node
constexpr int kNodeSize = 128;       ///< voxels along a lower internal node
constexpr int kRootChildSize = 4096; ///< voxels along an upper internal node

/// Position of a 128^3 node in units of nodes: its first voxel is 128 times that.
using NodeIndex = Vec3i;

/// Position of the node that holds a voxel coordinate, along one axis.
inline std::int32_t nodeOf(std::int64_t voxel) {
  return static_cast<std::int32_t>(voxel >> 7);
}

/// A face that matters in a 128^3 node.
struct NodeFace {
  NodeIndex node;
  std::uint32_t face;
  const NodeIndex& key() const { return node; }
  bool operator<(const NodeFace& o) const { return node != o.node ? node < o.node : face < o.face; }
};

} // namespace tetvdb
