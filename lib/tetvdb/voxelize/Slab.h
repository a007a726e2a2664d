// SPDX-License-Identifier: Apache-2.0
//
// The unit of rasterising: a slab, 8 x 128 x 128 voxels, one of the sixteen layers of leaves along
// x in a 128^3 internal node. Its 1024 rows along z are 128 bits each, 16 KB: it stays in the first
// cache, and its leaves touch their own words of the node's masks, so that the slabs of one node
// can be built at the same time.
#pragma once

#include "tetvdb/geometry/NodeIndex.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace tetvdb {

constexpr int kSlabsPerNode = kNodeSize / kLeafSize;
constexpr int kSlabRows = kLeafSize * kNodeSize;

/// Occupancy of a slab: row (x, y) at [x * 128 + y], bit z of the row in word z / 64.
struct SlabBits {
  alignas(64) std::uint64_t rows[kSlabRows][2];
};

/// Word with its lowest `n` bits set, 0 <= n <= 64.
inline std::uint64_t lowBits(int n) {
  return n >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << n) - 1;
}

/// Sets the bits lo <= z < hi of a row, 0 <= lo, hi <= 128; nothing where hi <= lo.
inline void setRun(std::uint64_t* row, int lo, int hi) {
  if (hi <= lo)
    return;
  if (lo < 64)
    row[0] |= lowBits(hi) & ~lowBits(lo);
  if (hi > 64)
    row[1] |= lowBits(hi - 64) & ~lowBits(lo > 64 ? lo - 64 : 0);
}

/// Receives the voxels of a rasteriser. begin(), the slabs (each index at most once, from any
/// thread), end(): for one node at a time and thread, many nodes at once. A slab that is not
/// delivered is empty.
class NodeSink {
public:
  /// A node under construction, owned by the sink; if it is destroyed without end(), it is
  /// discarded.
  struct Node {
    virtual ~Node() = default;
  };

  virtual ~NodeSink() = default;
  virtual std::unique_ptr<Node> begin(const NodeIndex& node) = 0;
  /// `owners`, where the rasteriser makes them: the tet of every voxel whose bit is set, at
  /// [(x * 128 + y) * 128 + z]; else null.
  virtual void slab(Node& node, int index, const SlabBits& bits, const std::uint32_t* owners) = 0;
  virtual void end(std::unique_ptr<Node> node) = 0;
  /// Nodes (x, y, z) with zBegin <= z < zEnd are full.
  virtual void fullRun(std::int32_t x, std::int32_t y, std::int32_t zBegin, std::int32_t zEnd) = 0;
  /// Every voxel of `node` belongs to tet `owner`.
  virtual void fullNode(const NodeIndex& node, std::uint32_t owner) = 0;
};

} // namespace tetvdb
