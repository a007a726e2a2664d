// SPDX-License-Identifier: Apache-2.0
//
// Where the z columns of a slab cross a triangle, exactly.
#pragma once

#include "tetvdb/geometry/Lattice.h"
#include "tetvdb/voxelize/Slab.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Crossings of one slab. A crossing at z changes the number of tets around every voxel of the row
/// from z on. One entering and one leaving crossing a voxel are bits; what is more goes to `extra`.
struct SlabCrossings {
  struct Extra {
    std::int32_t row; ///< x * 128 + y
    std::int32_t z;
    std::int32_t weight; ///< negative: leaving
  };
  SlabBits entering, leaving;
  std::vector<Extra> extra;

  void clear();
  void add(int row, int z, std::int32_t weight);
};

/// A boundary triangle prepared for rasterising. Columns are (x, y) of voxel centres; a column is
/// crossed where its perturbed centre (x + e, y + e^2) is inside the triangle seen along z, by the
/// ownership rule of Ownership.h with z left out.
class FaceRaster {
public:
  /// Normal of a, b, c pointing out of the mesh; extents at most kMaxTetExtent.
  FaceRaster(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
             std::int32_t weight);

  /// False where no column can be crossed: parallel to z, or between the columns.
  bool crossesColumns() const { return crosses_; }

  /// Columns and crossings lie within these inclusive bounds, voxels.
  std::int64_t xMin() const { return xMin_; }
  std::int64_t xMax() const { return xMax_; }
  std::int64_t yMin() const { return yMin_; }
  std::int64_t yMax() const { return yMax_; }
  std::int64_t zMin() const { return zMin_; }
  std::int64_t zMax() const { return zMax_; }

  /// Bounds of the crossings in the columns x0..x1, y0..y1 (inclusive, within the bounds above);
  /// false where there are none. Conservative.
  bool zRange(std::int64_t x0, std::int64_t x1, std::int64_t y0, std::int64_t y1,
              std::int64_t& zLow, std::int64_t& zHigh) const;

  /// Adds the crossings inside the slab whose first voxel is (x0, y0, z0).
  void rasterize(std::int64_t x0, std::int64_t y0, std::int64_t z0, SlabCrossings& slab) const;

private:
  template <typename Int>
  void rasterizeWith(std::int64_t x0, std::int64_t y0, std::int64_t z0, SlabCrossings& slab) const;
  std::int64_t exactCrossing(std::int64_t x, std::int64_t y, std::int64_t zNear) const;

  LatticePoint p_[3];       // counter-clockwise seen from +z
  std::int32_t weight_ = 0; // of a crossing: > 0 entering
  bool crosses_ = false;
  bool wide_ = false;              // needs 128 bits
  bool level_ = false;             // parallel to the xy plane
  double slopeX_ = 0, slopeY_ = 0; // dz/dx, dz/dy of the plane
  double tolerance_ = 0; // voxels; bound on the error of a crossing at the triangle's columns
  std::int64_t xMin_ = 0, xMax_ = -1, yMin_ = 0, yMax_ = -1, zMin_ = 0, zMax_ = -1;
};

} // namespace tetvdb
