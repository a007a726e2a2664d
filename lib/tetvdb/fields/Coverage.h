// SPDX-License-Identifier: Apache-2.0
//
// The filled share of every voxel's cube.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/fields/CoverageSum.h"
#include "tetvdb/geometry/NodeBox.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/BoundaryFaces.h"

#include <memory>
#include <vector>

namespace tetvdb {

namespace nano {
struct CoverageJob;
}

/// Fractions closer than this to 0 or 1 are set to 0 or 1.
constexpr double kCoverageError = 0x1p-32;

/// Returns a float fog "coverage": the share of each voxel's cube, centred on the sample, that is
/// inside. `points` are in world space and are not snapped. `faces` must be closed. With N(p) the
/// winding number of the faces around p (the number of tets around it, for the boundary of tets),
/// a voxel's value is the integral of N over its cube, limited to 0 to 1. Active where it is not
/// 0; 1 inside, as tiles; background 0. Values are correct within kCoverageError and the rounding
/// to a float, up or down: of the two floats next to a fraction, the one that minimizes the
/// leaf's accumulated error is used, so that the sum of a leaf's values is right to about 1e-7. The
/// result depends on the faces as a set, not on the number of threads. Voxels may be non-cubic. The
/// accuracy is lower for faces that are millions of voxels long. Cost: about 100 ns per pair of a
/// voxel and a face that meet.
openvdb::FloatGrid::Ptr coverage(const std::vector<Vec3d>& points, const Boundary& faces,
                                 const GridTransform& transform, CoverageSum& sum,
                                 Progress& progress);

/// Its faces, placed among slabs, for DeviceVoxelizer::coverage().
class CoverageFaces {
public:
  /// `faces` must outlive it. Parallel; 24 bytes a point and 16 a pair of a face and a slab of
  /// 8 x 128 x 128 voxels.
  CoverageFaces(const std::vector<Vec3d>& points, const Boundary& faces,
                const GridTransform& transform, Progress& progress);
  ~CoverageFaces();
  CoverageFaces(const CoverageFaces&) = delete;
  CoverageFaces& operator=(const CoverageFaces&) = delete;

  /// Refers to this.
  nano::CoverageJob job() const;

private:
  struct Placed;
  const Boundary& faces_;
  const GridTransform transform_;
  std::unique_ptr<Placed> placed_;
};

/// The same grid, box by box. What is carried upward is kept for one column of 4096^3 cubes: 16 to
/// 8208 bytes a stack of slabs.
class CoverageParts {
public:
  /// The arguments must outlive it, but for `progress`. Parallel; 24 bytes a point and 16 a pair of
  /// a face and a slab of 8 x 128 x 128 voxels.
  CoverageParts(const std::vector<Vec3d>& points, const Boundary& faces,
                const GridTransform& transform, Progress& progress);
  ~CoverageParts();
  CoverageParts(const CoverageParts&) = delete;
  CoverageParts& operator=(const CoverageParts&) = delete;

  /// The nodes of `box`, which is in one column of 4096^3 cubes. Boxes are cheapest in the order of
  /// a file, one after the other.
  openvdb::FloatGrid::Ptr grid(const NodeBox& box, Progress& progress);

  /// Begins anew: sum() is that of the boxes from now on.
  void begin();
  CoverageSum sum() const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

} // namespace tetvdb
