// SPDX-License-Identifier: Apache-2.0
//
// Determines on which side of a mesh a point lies, for shells on one side of it.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/SnappedMesh.h"

namespace tetvdb {

/// Keeps those active voxels of `shell` whose centres lie on the side to which the nearest face
/// looks (`inFront`), or on the other one: by the sign of the distance along the normal there,
/// which where the nearest point is on an edge or a vertex is the sum of the normals of the faces
/// that meet there, weighted by their angles (Baerentzen and Aanaes, Signed Distance Computation
/// Using the Angle Weighted Pseudonormal, 2005). A centre at distance 0 along it is decided by the
/// sign of the normal's first component that is not zero, as by the perturbation of
/// geometry/Ownership.h. Meant for open meshes; a point beyond their boundary edges is decided by
/// the plane of the nearest boundary face. No active voxel is farther from the mesh than
/// `farthest`, world units. Parallel by leaves; costs one search for the nearest face a voxel.
void keepSide(openvdb::BoolTree& shell, const TriangleMesh& mesh, const SnappedMesh& snapped,
              const Vec3d& voxelSize, double farthest, bool inFront, Progress& progress);

} // namespace tetvdb
