// SPDX-License-Identifier: Apache-2.0
//
// Computes the hash of a grid from parts of it, and that of a volume from its grids, equal to
// hash().
#pragma once

#include "tetvdb/volume/Grids.h"

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

/// The hash of a grid that is given in parts: each has other entries of the root node, in any
/// order, or other entries of one of its children. Those of a child come together; what a part does
/// not have of it are inactive voxels of the background's value.
class GridHash {
public:
  /// `grid`: with name, class, transform and background. Throws Error(Usage) for a grid type that
  /// is unknown.
  explicit GridHash(const openvdb::GridBase& grid);
  ~GridHash();
  GridHash(const GridHash&) = delete;
  GridHash& operator=(const GridHash&) = delete;

  void add(const openvdb::GridBase& part);
  /// 16 bytes; call once.
  std::string finish();

private:
  struct Entries;
  std::unique_ptr<Entries> entries_;
};

/// 32 hexadecimal digits of grids by name and hash.
std::string hashOfGrids(std::vector<std::pair<std::string, std::string>> grids);

} // namespace tetvdb
