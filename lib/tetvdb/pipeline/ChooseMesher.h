// SPDX-License-Identifier: Apache-2.0
//
// By which method triangles become a solid.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

namespace tetvdb {

/// Throws Error(Usage) where what the job asks for excludes each other: tets of a method that makes
/// none, a shell of tets.
void checkMesher(const VoxelizeJob& job);

/// The method for a job that checkMesher() has passed: what the job says, and for Mesher::Auto the
/// envelope mesher where tets are asked for (the grid tet_id, a mesh output of tets, an epsilon),
/// otherwise the winding number, which is exact for closed meshes at any voxel size. The diagonal
/// of the mesh's box and the voxel size, both in world units, serve to find epsilon.
MesherChoice chooseMesher(const VoxelizeJob& job, double diagonal, const Vec3d& voxelSize);

/// Whether grids or mesh output need tets, so that no other method will do.
bool needsTets(const VoxelizeJob& job);

} // namespace tetvdb
