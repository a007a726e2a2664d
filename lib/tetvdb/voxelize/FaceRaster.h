// SPDX-License-Identifier: Apache-2.0
//
// Computes exactly where the z columns of a slab cross a triangle.
#pragma once

#include "tetvdb/geometry/ColumnBounds.h"
#include "tetvdb/voxelize/Slab.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Crossings of one slab. A crossing at z changes the number of tets around every voxel of the row
/// from z on. One entering and one leaving crossing a voxel are kept as bits; further ones are kept
/// in `extra`.
struct SlabCrossings {
  struct Extra {
    std::int32_t row; ///< x * 128 + y
    std::int32_t z;
    std::int32_t weight; ///< negative: leaving
  };
  SlabBits entering, leaving;
  std::vector<Extra> extra;

  void clear();
  void add(int row, int z, std::int32_t weight) {
    std::uint64_t& word = (weight > 0 ? entering : leaving).rows[row][z >> 6];
    const std::uint64_t bit = std::uint64_t(1) << (z & 63);
    const std::int32_t one = weight > 0 ? 1 : -1;
    if (word & bit) {
      extra.push_back({row, z, weight});
      return;
    }
    word |= bit;
    if (weight != one)
      extra.push_back({row, z, weight - one});
  }
};

/// A boundary face prepared for rasterising.
class FaceRaster : public CrossedFace {
public:
  /// Normal of a, b, c pointing out of the mesh; extents at most kMaxTetExtent.
  FaceRaster(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
             std::int32_t weightOfFace);

  /// Adds the crossings inside the slab whose first voxel is (x0, y0, z0).
  void rasterize(std::int64_t x0, std::int64_t y0, std::int64_t z0, SlabCrossings& slab) const;

private:
  template <typename Int>
  void rasterizeWith(std::int64_t x0, std::int64_t y0, std::int64_t z0, SlabCrossings& slab) const;

  bool wide_ = false;  // needs 128 bits
  bool level_ = false; // parallel to the xy plane
};

} // namespace tetvdb
