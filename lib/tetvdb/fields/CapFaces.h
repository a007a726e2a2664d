// SPDX-License-Identifier: Apache-2.0
//
// The surface of an open soup's solid where it closes a hole: there the winding number passes a
// half and no face is.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstddef>

namespace tetvdb {

/// Where neighbouring centres are on different sides of `inside` and yet `levelSet` says that no
/// face is between them (its two absolute values add up to more than a voxel), adds faces to
/// `faces` and their corners to `mesh`: a quadrilateral around every such pair, with corners at the
/// mean of the places where the winding number of `boundary` passes a half between pairs of
/// centres, by linear interpolation. They are within a voxel of the surface where the winding
/// number is a half, and every such pair has one between its centres. Returns how many pairs there
/// were. Depends on nothing but its arguments; parallel; a winding number a centre and 200 bytes a
/// pair.
std::size_t addCapFaces(const openvdb::FloatGrid& levelSet, const openvdb::BoolGrid::Ptr& inside,
                        const GridTransform& transform, const BoundaryWinding& boundary,
                        SnappedMesh& mesh, Boundary& faces, Progress& progress);

} // namespace tetvdb
