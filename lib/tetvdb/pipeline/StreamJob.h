// SPDX-License-Identifier: Apache-2.0
//
// A job's occupancy straight into a .vdb file, without a tree in memory (io/volume/BitVdbWriter.h).
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/pipeline/VoxelizeJob.h"
#include "tetvdb/voxelize/SolidFaces.h"

#include <map>
#include <string>
#include <vector>

namespace tetvdb {

/// Whether the job's output can be streamed as bits: a .vdb file of density and mask alone, and
/// nothing that needs a volume in memory or a mesh besides (a preview, VoxelizeJob::keep, `fit`,
/// shells, a flood, a mesh output). Other grids: canStreamTrees() (pipeline/StreamTrees.h).
bool canStream(const VoxelizeJob& job);

/// Throws Error(Usage) for a shard of a job that cannot be streamed.
void requireStreamable(const VoxelizeJob& job);

/// Writes job.output where job.streaming says so, where the grids' trees would not fit into memory,
/// or where that is faster: from 2^17 leaves on, unless a GPU could voxelize tets and it is not
/// said whether it should. With DeviceKind::Cuda one GPU finds the occupancy, a column of cubes at
/// a time, but of open meshes. The bytes are the same. False, with nothing done and nothing said,
/// where the job is left to the trees. `metadata`: more of it for the file. Memory: the mesh, which
/// is released where it is not needed any more, 64 bytes a face, 16 a pair of face and 128^3 node,
/// and about 100 MB. Throws as voxelize() and BitVdbWriter do. Jobs with other grids:
/// streamTrees(). `meshes`: one, or the materials.
bool streamTets(const VoxelizeJob& job, TetMesh& mesh, VoxelizeResult& result, Report& report,
                Progress& progress);
bool streamTriangles(const VoxelizeJob& job, const std::vector<TriangleMesh>& meshes,
                     const std::map<std::string, std::string>& metadata, VoxelizeResult& result,
                     Report& report, Progress& progress);

/// Writes job.output, or finds its plan, from the boundary of tets; canStream(job). Adds stages
/// "voxelize" and "write".
void streamFaces(const VoxelizeJob& job, const SolidFaces& faces, const GridTransform& transform,
                 VoxelizeResult& result, Report& report, Progress& progress);

} // namespace tetvdb
