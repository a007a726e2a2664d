// SPDX-License-Identifier: Apache-2.0
//
// The surface of an open soup's solid where a hole is closed: the winding number equals 0.5 there,
// without a face.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/geometry/NodeBox.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

/// Two neighbouring centres, the second in the positive direction of `axis`.
struct CentrePair {
  Vec3i first;
  int axis;
};

/// Neighbouring centres on different sides of `inside` without a face between them by `levelSet`
/// (its two absolute values add up to more than a voxel). `box`: the nodes of the first centres, of
/// which and of whose next nodes in the positive directions the grids must be known; null: all.
/// Parallel by leaves.
std::vector<CentrePair> findPairsWithoutFace(const openvdb::FloatGrid& levelSet,
                                             const openvdb::BoolGrid::Ptr& inside,
                                             const GridTransform& transform, const NodeBox* box,
                                             Progress& progress);

/// For such pairs, in any order, appends faces to `faces` and their corners to `mesh`: a
/// quadrilateral around every pair, with corners at the mean of the points where the winding number
/// of `boundary` passes 0.5 between pairs of centres, by linear interpolation. They are within a
/// voxel of the surface where the winding number is 0.5, and every such pair has one between its
/// centres. Deterministic; parallel; costs one winding number per centre and 200 bytes per pair.
void addCapFaces(std::vector<CentrePair> pairs, const BoundaryWinding& boundary, SnappedMesh& mesh,
                 Boundary& faces, Progress& progress);

/// Both. Returns the number of pairs.
std::size_t addCapFaces(const openvdb::FloatGrid& levelSet, const openvdb::BoolGrid::Ptr& inside,
                        const GridTransform& transform, const BoundaryWinding& boundary,
                        SnappedMesh& mesh, Boundary& faces, Progress& progress);

} // namespace tetvdb
