// SPDX-License-Identifier: Apache-2.0
//
// A job's grids of any kind into a .vdb or .nvdb file or tiles, box by box (pipeline/JobTrees.h,
// io/volume/TreeWriter.h, io/volume/TileFolder.h).
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/pipeline/TetSource.h"
#include "tetvdb/pipeline/VoxelizeJob.h"
#include "tetvdb/voxelize/SolidFaces.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

/// Whether the job has other grids than density and mask, or writes a .nvdb file, and all can be
/// made box by box.
bool canStreamTrees(const VoxelizeJob& job);

/// Writes job.output where job.streaming says so, and where the grids' trees would not fit into
/// memory. The bytes are the same. False, with nothing done and nothing said, where the job is left
/// to the trees. Memory: the mesh and what is found once for all of it, and a third of what may be
/// taken, at most 1 GB, for trees; with levels a sixth, and half for these. Throws as the in-memory
/// way does, Error(Limit) where this is too small for the grids of 128^3 voxels, and Error(Write).
/// `meshes`: one, or the materials.
bool streamTrees(const VoxelizeJob& job, const TetMesh& mesh, VoxelizeResult& result,
                 Report& report, Progress& progress);
bool streamTrees(const VoxelizeJob& job, const std::vector<TriangleMesh>& meshes,
                 const std::map<std::string, std::string>& metadata, VoxelizeResult& result,
                 Report& report, Progress& progress);

/// A mesh of tets that is not in memory; what the job does not need is empty.
struct PreparedInputs {
  GridTransform transform;
  std::string mark;          ///< of the mesh
  std::vector<Vec3d> points; ///< of the boundary
  std::optional<SolidFaces> faces;
  TetSource* tets = nullptr;
  const std::vector<Field>* fields = nullptr;
};

/// The same of such a mesh, in any case; canStreamTrees(job).
void streamTrees(const VoxelizeJob& job, const PreparedInputs& mesh, VoxelizeResult& result,
                 Report& report, Progress& progress);

} // namespace tetvdb
