// SPDX-License-Identifier: Apache-2.0
//
// Coarser grids of a volume: level k has voxels 2^k times as long. Voxel i of it covers the voxels
// 2^k i to 2^k i + 2^k - 1 of the grid, so that its centre lies (2^k - 1) / 2 voxels beyond that of
// voxel 2^k i: its transform says so, and all levels have the same place in world space.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace tetvdb {

constexpr int kMaxLevel = 12; ///< a voxel of it covers a child of the root node

/// The levels first, first + 1, ..., last.
struct LevelRange {
  int first = 0, last = 0; ///< 1 to kMaxLevel; 0: none
  bool isEmpty() const { return last == 0; }
  std::size_t size() const { return isEmpty() ? 0 : static_cast<std::size_t>(last - first + 1); }
};

/// "NAME_level_3"
std::string levelName(const std::string& grid, int level);

/// Throws Error(Usage) unless the levels are within 1 to kMaxLevel, in order.
void checkLevels(const LevelRange& levels);

/// Throws Error(Usage) for a grid, of a value type and class as OpenVDB names them, whose values
/// have no mean or whose mean is of no use: numbers of cells or materials, level sets.
void requireLevels(const std::string& name, std::string_view type, std::string_view gridClass);

/// Adds grids after the volume's own. Of masks and of grids named density, fog or coverage, a voxel
/// of level k has the sum of the values of the 8^k voxels that it covers, divided by their number;
/// inactive ones count as 0. So of density and mask it is the exact share of voxels that are
/// inside, rounded once to float. Of other grids of floats or vectors it has the mean of the active
/// ones. It is active where any of them is. All sums are of doubles, in an order that does not
/// depend on the number of threads. Memory: that of the coarser trees; `maxMemory` bounds their
/// leaves, in bytes (0: what is available), beyond which Error(Limit) is thrown. Throws as
/// checkLevels() and requireLevels() do, and Error(Usage) for a transform that is not linear; the
/// volume is unchanged then.
void addLevels(Volume& volume, const LevelRange& levels, std::size_t maxMemory, Progress& progress);

} // namespace tetvdb
