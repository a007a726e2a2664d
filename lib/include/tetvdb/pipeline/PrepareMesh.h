// SPDX-License-Identifier: Apache-2.0
//
// Meshes of linear cells that are larger than memory: prepared once, then voxelized part by part.
//
//   tetvdb::VoxelizeJob job;
//   job.inputs = {"engine.vtu"};
//   job.grids = {tetvdb::GridKind::TetId};
//   job.voxelize.voxelSize = {0.5, 0.5, 0.5};
//   job.maxMemory = std::size_t(1) << 30;
//   tetvdb::prepareMesh(job, "engine.prepared", report, progress);
//   job.inputs = {"engine.prepared"};           // in place of the file, here or elsewhere
//   job.voxelize = {};
//   job.output = "engine.vdb";
//   tetvdb::run(job, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace tetvdb {

/// A folder that prepareMesh() has written.
struct PreparedMesh {
  InputInfo input; ///< of the file that it was made of
  GridTransform transform;
  SnapCounts counts;
  UpAxis up = UpAxis::Z;
  std::size_t buckets = 0;      ///< boxes of nodes whose tets are in memory at a time
  std::uint64_t mostTets = 0;   ///< of a bucket
  std::uint64_t storedTets = 0; ///< in all buckets: more than the mesh has, since they overlap
  std::uint64_t bytes = 0;      ///< of all files
  std::vector<std::string> arrays;
};

/// Reads job.inputs, one file of linear cells (CellMesh.h) of a format with FormatUse::SpoolCells,
/// part by part, and writes what voxelizing needs of it into `folder`, which is whole or absent:
/// the boundary faces; and, if job.grids or job.fields need owners, the tets of boxes of nodes, as
/// large as a share of job.maxMemory allows, with the arrays that job.fields asks for. The voxels'
/// size and place are those of job.voxelize. Temporary files without names take the mesh's size
/// beside the folder. Memory: within job.maxMemory, but for 48 bytes a boundary face, 8 bytes for
/// every 512 points, a bit a point, and 100 bytes a node of 128^3 voxels that tets meet; mapped
/// pages are given back above half of it. Adds stages "read" and "prepare" to `report`. Throws
/// Error(Usage) for other inputs and settings that need the whole mesh, else as run() does;
/// Error(Write).
PreparedMesh prepareMesh(const VoxelizeJob& job, const std::string& folder, Report& report,
                         Progress& progress);

/// Whether `path` is a folder with the index of a prepared mesh.
bool isPreparedMesh(const std::string& path);

/// What the folder holds, after its index and the sizes of its files were checked. Throws
/// Error(Invalid).
PreparedMesh describePrepared(const std::string& folder);

} // namespace tetvdb
