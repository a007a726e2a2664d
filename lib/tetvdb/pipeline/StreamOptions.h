// SPDX-License-Identifier: Apache-2.0
//
// What all ways to stream a job take from it.
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/io/volume/PartMetadata.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <cstddef>
#include <openvdb/openvdb.h>
#include <string>

namespace tetvdb {

/// Whether the job writes a .vdb or .nvdb file or tiles alone, of a solid and not of a shell or a
/// flood, and may stream it.
bool mayStream(const VoxelizeJob& job);

/// Whether it writes a .nvdb file.
bool writesNvdb(const VoxelizeJob& job);

/// Whether grids of arrays are packed on their way into the file where it is not streamed: in place
/// of whole trees there are their leaves as the file has them.
bool packsArrays(const VoxelizeJob& job);

/// Whether it is streamed in any case.
bool mustStream(const VoxelizeJob& job);

/// Bytes that the job may still take.
std::size_t streamLimit(const VoxelizeJob& job);

/// What whole trees of so many bytes take in all: tiles are made of copies of their nodes.
double bytesWithCopies(const VoxelizeJob& job, double trees);

/// The job's options for all of its grids.
VoxelizeOptions streamOptions(const VoxelizeJob& job);

/// Equal for the shards of one job alone. `mark`: what the mesh's voxels follow from.
PartMetadata partMetadata(const VoxelizeJob& job, const GridTransform& transform,
                          const std::string& mark);

/// What the grids of levels lack when their voxels are known: as openFirstTile() does, or the mark
/// of a part, in which several shards may have voxels of a node.
void finishLevels(const VoxelizeJob& job, const openvdb::GridPtrVec& levels);

/// Moves what was said while it was not known whether the job is done to its report.
void moveReport(Report& told, Report& report);

} // namespace tetvdb
