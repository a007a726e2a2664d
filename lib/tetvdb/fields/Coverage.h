// SPDX-License-Identifier: Apache-2.0
//
// How much of every voxel's cube a solid fills.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/fields/CoverageSum.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/BoundaryFaces.h"

#include <vector>

namespace tetvdb {

/// Fractions nearer than this to 0 or 1 are 0 or 1.
constexpr double kCoverageError = 0x1p-32;

/// A float fog "coverage": of every voxel the share of its cube, centred on the sample, that is
/// inside. `points` are in world space, as they are: not snapped. `faces` must close. With N(p) the
/// winding number of the faces around p (the number of tets around it, for the boundary of tets), a
/// voxel's value is the integral of N over its cube, between 0 and 1. Active where it is not 0; 1
/// inside, as tiles; background 0. Values are right within kCoverageError and the rounding to a
/// float, up or down: of the two floats next to a fraction that one is taken that brings the sum so
/// far nearer to the truth, so that the values' sum is the volume of the mesh to about 1e-7 voxel
/// for every 8 x 128 columns of voxels that the solid's surface meets. The result depends on the
/// faces as a set; any thread count gives the same. Voxels need not be cubes. For faces that are
/// millions of voxels long doubles leave less. Cost: about 100 ns for each voxel and face that
/// meet.
openvdb::FloatGrid::Ptr coverage(const std::vector<Vec3d>& points, const Boundary& faces,
                                 const GridTransform& transform, CoverageSum& sum,
                                 Progress& progress);

} // namespace tetvdb
