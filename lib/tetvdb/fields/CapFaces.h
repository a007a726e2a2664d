// SPDX-License-Identifier: Apache-2.0
//
// The surface of an open soup's solid where a hole is closed: the winding number equals 0.5 there,
// without a face.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstddef>

namespace tetvdb {

/// For neighbouring centres on different sides of `inside` without a face between them by
/// `levelSet` (its two absolute values add up to more than a voxel), appends faces to `faces`
/// and their corners to `mesh`: a quadrilateral around every such pair, with corners at the
/// mean of the points where the winding number of `boundary` passes 0.5 between pairs of
/// centres, by linear interpolation. They are within a voxel of the surface where the winding
/// number is 0.5, and every such pair has one between its centres. Returns the number of
/// pairs. Deterministic; parallel; costs one winding number per centre and 200 bytes per
/// pair.
std::size_t addCapFaces(const openvdb::FloatGrid& levelSet, const openvdb::BoolGrid::Ptr& inside,
                        const GridTransform& transform, const BoundaryWinding& boundary,
                        SnappedMesh& mesh, Boundary& faces, Progress& progress);

} // namespace tetvdb
