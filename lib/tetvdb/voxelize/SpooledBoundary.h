// SPDX-License-Identifier: Apache-2.0
//
// The boundary of a tet mesh that is not in memory.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/SpooledMesh.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/BoundaryFaces.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

struct SpooledBoundary {
  std::vector<Vec3d> points; ///< those on the boundary, in the mesh's order
  Boundary chain;            ///< of these
};

/// The faces of boundaryFaces(), in the same order. The mesh is passed once for every `bytes` / 8
/// vertices, once more to count the faces around open ones, and once for every `bytes` / 12 of
/// these. Memory: about `bytes`, three bits a point, 8 bytes for every 512 points, 16 a face found
/// and 28 a point on it; mapped pages are given back above `maxResident` bytes of the process.
/// Throws as boundaryFaces() and snapMesh().
SpooledBoundary spooledBoundary(const SpooledMesh& mesh, const GridTransform& transform,
                                std::size_t bytes, std::size_t maxResident, Progress& progress);

} // namespace tetvdb
