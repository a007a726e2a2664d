// SPDX-License-Identifier: Apache-2.0
//
// One .vdb file of the parts that shards have written (VoxelizeJob::shard): a new header, and the
// bytes of the parts' nodes as they are; those of levels of detail, in which several parts may have
// voxels, are joined.
//
//   tetvdb::mergeVdb({"part0.vdb", "part1.vdb"}, "whole.vdb", {}, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

struct MergeOptions {
  bool allowEmpty = false; ///< false: a volume without active voxels is Error(Invalid)
};

struct MergeResult {
  std::size_t parts = 0;
  std::uint64_t activeVoxels = 0, leaves = 0; ///< of the first grid
  std::vector<std::string> grids;
};

/// Writes the volume that the parts make up to `output`, whole or absent: the bytes that one
/// process would have written, for parts in any order. Throws Error(Invalid), with the file's name,
/// for a file that is no part, is cut, belongs to another volume or comes twice, and with the
/// numbers of those that are missing; Error(Write). Memory: a few MB, 30 MB where grids have the
/// entry file_delayed_load, and of levels of detail one child of the root node at a time, 2.1 KB a
/// leaf.
MergeResult mergeVdb(const std::vector<std::string>& parts, const std::string& output,
                     const MergeOptions& options, Progress& progress);

} // namespace tetvdb
