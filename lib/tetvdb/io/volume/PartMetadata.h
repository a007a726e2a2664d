// SPDX-License-Identifier: Apache-2.0
//
// The metadata of a .vdb file that is a part of a volume. Its grids also state how many leaves they
// have (kPartLeaves), which merging needs, or are those of levels of detail (kPartLevel).
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace tetvdb {

/// Metadata of a grid: an int64.
constexpr const char* kPartLeaves = "part_leaves";
/// Metadata of a grid: a bool. Other parts may have voxels in its nodes, as those of levels of
/// detail have in their larger ones. True: the volume has it as half, which is rounded when all
/// nodes are known.
constexpr const char* kPartLevel = "part_level";

struct PartMetadata {
  unsigned index = 0, count = 0; ///< part `index` of `count`
  std::string job;               ///< equal for the parts of one volume, and only for these

  /// Entries of the file's metadata.
  void add(std::map<std::string, std::string>& metadata) const;
  /// Removes them. False if they are missing or invalid.
  bool take(std::map<std::string, std::string>& metadata);
};

} // namespace tetvdb
