// SPDX-License-Identifier: Apache-2.0
//
// Extracts the leaves of a slab from its rows of bits.
#pragma once

#include "tetvdb/voxelize/Slab.h"

#include <cstdint>

namespace tetvdb {

/// Which of the sixteen leaves of a slab with y / 8 = leafY are empty, full or mixed.
class LeafRows {
public:
  LeafRows(const SlabBits& bits, int leafY) : bits_(bits), leafY_(leafY) {
    for (int x = 0; x < kLeafSize; ++x)
      for (int y = 0; y < kLeafSize; ++y) {
        const std::uint64_t* row = bits.rows[x * kNodeSize + leafY * kLeafSize + y];
        any_[0] |= row[0];
        any_[1] |= row[1];
        all_[0] &= row[0];
        all_[1] &= row[1];
      }
  }
  bool empty() const { return (any_[0] | any_[1]) == 0; }
  bool empty(int leafZ) const { return byte(any_, leafZ) == 0; }
  bool full(int leafZ) const { return byte(all_, leafZ) == 0xFF; }

  /// Mask word of x slab `x` of the leaf: bit 8 y + z.
  std::uint64_t word(int leafZ, int x) const {
    std::uint64_t w = 0;
    const int shift = (leafZ & 7) * 8;
    for (int y = 0; y < kLeafSize; ++y)
      w |= (bits_.rows[x * kNodeSize + leafY_ * kLeafSize + y][leafZ >> 3] >> shift & 0xFF)
           << (8 * y);
    return w;
  }

private:
  static std::uint64_t byte(const std::uint64_t* words, int leafZ) {
    return words[leafZ >> 3] >> ((leafZ & 7) * 8) & 0xFF;
  }
  const SlabBits& bits_;
  int leafY_;
  std::uint64_t any_[2] = {0, 0};
  std::uint64_t all_[2] = {~std::uint64_t(0), ~std::uint64_t(0)};
};

/// Calls visit(rows, leafY, leafZ, entry) for the leaves of slab `index` that are not empty, in
/// order; `entry`: of the 128^3 node.
template <class Visit>
void eachLeaf(const SlabBits& bits, int index, const Visit& visit) {
  for (int leafY = 0; leafY < kSlabsPerNode; ++leafY) {
    const LeafRows rows(bits, leafY);
    for (int leafZ = 0; leafZ < kSlabsPerNode && !rows.empty(); ++leafZ)
      if (!rows.empty(leafZ))
        visit(rows, leafY, leafZ, index << 8 | leafY << 4 | leafZ);
  }
}

} // namespace tetvdb
