// SPDX-License-Identifier: Apache-2.0
//
// A volume as a folder of .vdb files, one a cube of its voxels, for programs that cannot hold it
// whole, and tiles.json, which says what is where (docs/huge.md).
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/volume/LevelsOfDetail.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

/// The most files of one folder.
constexpr std::size_t kMaxTileFiles = 100000;

/// Coarser grids of the files (addLevels()). Corners of files are at multiples of their size: a
/// voxel of a level lies in one file, and the files' levels together are those of the whole volume.
struct TileLevels {
  LevelRange range = {};
  std::size_t maxMemory = 0; ///< bytes of the levels of one file; 0: what is available
};

/// What was written.
struct TileFilesInfo {
  std::vector<GridInfo> grids; ///< over all files
  std::size_t files = 0;       ///< without tiles.json
  std::uint64_t bytes = 0;     ///< of all, tiles.json too
};

/// Throws Error(Usage) unless `size` is 512, 1024, 2048 or 4096: nodes of 128^3 voxels are not cut,
/// and no file has voxels of two children of the root node. The same where `folder` is a file, or
/// holds other files, and for levels whose voxels are larger than the files' cubes; Error(Write)
/// where the folder cannot be made.
void checkTileFiles(const std::string& folder, int size, const LevelRange& levels = {});

/// Writes the cubes of size^3 voxels, whose corners are at multiples of `size`, that hold anything
/// but inactive voxels of the background's value: tile_0.vdb and so on, in order of the root's
/// children and within one by x, then y, then z. Each has all grids, at their places, and after
/// them the levels of what it holds; tiles are opened as openFirstTile() does. The folder is whole
/// or absent: it is made under another name. An existing one is replaced if it holds such files
/// alone. Throws as checkTileFiles(), Error(Usage) for grids whose transforms or types do not allow
/// it, Error(Limit) for more than kMaxTileFiles and for levels that do not fit, Error(Write).
TileFilesInfo writeTileFiles(const std::string& folder, int size, const Volume& volume,
                             Progress& progress, const TileLevels& levels = {});

/// The same of a .vdb file for which canStreamVolume() is true, with `names` alone if there are
/// any: one child of the root node is in memory at a time. Throws Error(Usage) for a name that the
/// file does not have, and as describeVolumeFile() does.
TileFilesInfo splitVolumeFile(const std::string& path, const std::vector<std::string>& names,
                              const std::string& folder, int size, Progress& progress,
                              const TileLevels& levels = {});

} // namespace tetvdb
