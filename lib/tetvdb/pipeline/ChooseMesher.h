// SPDX-License-Identifier: Apache-2.0
//
// Chooses the method that converts triangles into a solid.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

namespace tetvdb {

/// Throws Error(Usage) if options of the job exclude each other: tets of a method that makes none,
/// a shell of tets.
void checkMesher(const VoxelizeJob& job);

/// The method for a job that checkMesher() accepts: that of the job, and for Mesher::Auto the
/// envelope mesher if tets are required (the grid tet_id, a mesh output of tets, an epsilon),
/// otherwise the winding number, which is exact for closed meshes at any voxel size. The diagonal
/// of the mesh's box and the voxel size, both in world units, determine epsilon.
MesherChoice chooseMesher(const VoxelizeJob& job, double diagonal, const Vec3d& voxelSize);

/// Whether grids or mesh output require tets, so that no other method can be used.
bool needsTets(const VoxelizeJob& job);

} // namespace tetvdb
