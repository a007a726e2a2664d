// SPDX-License-Identifier: Apache-2.0
//
// What volume/Volume.h says of volumes, of files that need not fit into memory: one child of a
// root node, 4096^3 voxels, is read at a time, or less.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/volume/LevelsOfDetail.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace tetvdb {

/// Whether `path` is a .vdb file whose grids, one at least, can be read child by child: of version
/// 222 and above, of types that have typed code, none an instance of another.
bool canStreamVolume(const std::string& path);

/// The same, of a file of 256 MB or more: its grids take some times as much memory.
bool isLargeVolume(const std::string& path);

struct StreamedInfo {
  std::map<std::string, std::string> metadata; ///< of the file
  std::vector<GridInfo> grids;                 ///< as describe() gives them
  std::string hash;                            ///< as hash() gives it, where it was asked for
  Volume empty;                                ///< the file's, its grids without voxels
};

/// Reads the file once. The sum of a coverage grid may differ from describe()'s by rounding. Throws
/// Error(Invalid) for a file that is not whole, Error(Usage) where canStreamVolume() is false.
StreamedInfo describeVolumeFile(const std::string& path, bool withHash, Progress& progress);

/// As compareVolumes(), of files. Reads both twice: once for the hashes.
VolumeComparison compareVolumeFiles(const std::string& a, const std::string& b, Progress& progress);

struct VolumeConversion {
  std::string input, output;      ///< .vdb or .nvdb files
  std::vector<std::string> grids; ///< in that order; empty: all
  std::size_t maxMemory = 0;      ///< bytes that may be taken besides what is
  LevelRange levels = {};         ///< coarser grids that come after all others (addLevels())
};

/// Whether convertVolumeFile() reads the file: a .nvdb file, or canStreamVolume() is true.
bool canConvertVolume(const std::string& path);

/// Writes the grids of a file into another: the bytes that writeVolume() would make of
/// readVolume()'s. Memory: nodes of 128^3 voxels, a quarter of `maxMemory` of them, or one where
/// this takes more, three eighths for what is made of them, and half for levels. The output's
/// folder needs room for the file twice, and for the bytes of a .nvdb input uncompressed. What was
/// written is returned. Throws Error(Invalid) for a file that is not whole, Error(Usage) for grids
/// that the output cannot hold or that have no levels, Error(Limit) for levels that do not fit,
/// Error(Write).
std::vector<GridInfo> convertVolumeFile(const VolumeConversion& files, Progress& progress);

} // namespace tetvdb
