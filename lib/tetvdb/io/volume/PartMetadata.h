// SPDX-License-Identifier: Apache-2.0
//
// The metadata of a .vdb file that is a part of a volume. Its grids also state how many leaves they
// have (kPartLeaves), which merging needs.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace tetvdb {

/// Metadata of a grid: an int64.
constexpr const char* kPartLeaves = "part_leaves";

struct PartMetadata {
  unsigned index = 0, count = 0; ///< part `index` of `count`
  std::string job;               ///< equal for the parts of one volume, and only for these

  /// Entries of the file's metadata.
  void add(std::map<std::string, std::string>& metadata) const;
  /// Removes them. False if they are missing or invalid.
  bool take(std::map<std::string, std::string>& metadata);
};

} // namespace tetvdb
