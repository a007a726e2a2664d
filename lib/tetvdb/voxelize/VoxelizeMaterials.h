// SPDX-License-Identifier: Apache-2.0
//
// Voxelizes several triangle meshes, each a material, into sparse grids, without tets.
//
//   const std::vector<std::string> names{"housing.stl", "shaft.stl"};
//   tetvdb::Voxelization result = tetvdb::voxelizeMaterials(meshes, names, {}, options, report,
//                                                           progress);
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <string>
#include <vector>

namespace tetvdb {

/// Voxelizes every mesh as voxelize() does, all by one transform: that of the box around them all.
/// GridKind::Material is an int32 grid: 1 where the first mesh's solid is, 2 where the second's is
/// and the first's is not, and so on; the background is -1. GridKind::Density and Mask have the
/// voxels that are in any of the solids, which are those with a material. The result depends on the
/// order of the meshes and on each mesh's faces as a set.
///
/// A mesh whose solid has no voxel is a warning ("no-voxels") and makes `report` partial; where
/// none has, Error(Invalid) unless options.allowEmpty. `names` begin messages about a mesh, one
/// each. Adds stage "voxelize" with a part for every mesh. Throws what voxelize() throws,
/// Error(Usage) for no mesh, another number of names, GridKind::TetId, or Material by another rule
/// than the centre's. Memory: that of voxelize() for one mesh after the other, and a mask a mesh.
Voxelization voxelizeMaterials(const std::vector<TriangleMesh>& meshes,
                               const std::vector<std::string>& names, const SolidOptions& solid,
                               const VoxelizeOptions& options, Report& report, Progress& progress);

/// The same grids of masks that are there: what is in the first is the first material.
openvdb::GridPtrVec materialGrids(const std::vector<GridKind>& kinds,
                                  const std::vector<openvdb::BoolGrid::ConstPtr>& masks,
                                  const GridTransform& transform, Progress& progress);

/// Passes the warnings `own` of the mesh `name` on to `report`, and adds that it has no voxels
/// where that is so.
void noteMaterial(const std::string& name, bool empty, const Report& own, Report& report);

/// Throws Error(Invalid) where no mesh has voxels, unless options.allowEmpty.
void requireMaterials(bool empty, const VoxelizeOptions& options);

} // namespace tetvdb
