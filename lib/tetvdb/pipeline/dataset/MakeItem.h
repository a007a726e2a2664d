// SPDX-License-Identifier: Apache-2.0
//
// Makes the arrays and grids of one model of a data set from its file.
//
//   tetvdb::DatasetItem item{entry, 0};
//   tetvdb::ItemResult result = tetvdb::makeItem(item, options, "data", report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/dataset/DatasetOptions.h"
#include "tetvdb/pipeline/dataset/Manifest.h"
#include "tetvdb/pipeline/dataset/NamedArray.h"
#include "tetvdb/pipeline/dataset/NormalizeModel.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

struct DatasetItem {
  DatasetEntry entry;
  int variant = 0;

  /// The entry's identifier; for variants followed by "_v1" and so on.
  std::string name() const;
};

struct ItemGrid {
  int size = 0;               ///< voxels along each side
  std::uint64_t occupied = 0; ///< voxels
  std::string hash;           ///< of the occupied voxels
};

struct ItemResult {
  std::string fileHash; ///< XXH3, 128 bits, of the file's bytes
  std::size_t faces = 0, cleanFaces = 0, openEdges = 0;
  Matrix4 transform{}; ///< from the file's coordinates to those of the arrays
  double volume = 0;   ///< of the occupied voxels at the largest resolution, as normalised
  std::vector<ItemGrid> grids;
  std::vector<std::string> files; ///< within the folder
};

/// Reads, cleans, normalises and voxelizes the model and writes its files into `folder`, named by
/// its identifier, below SPLIT/CLASS where that names no folders itself. Files are whole or absent;
/// they depend only on the model's bytes, the options and the variant. Adds stages "read", "clean",
/// "voxelize", "fields", "points", "write" to `report`. Throws what these stages throw, such as
/// Error(Invalid) for a mesh without an inside if one is needed.
ItemResult makeItem(const DatasetItem& item, const DatasetOptions& options,
                    const std::string& folder, Report& report, Progress& progress);

/// The arrays of makeItem() in memory, booleans packed. Writes no file and ignores the formats.
ItemResult makeItemArrays(const DatasetItem& item, const DatasetOptions& options,
                          std::vector<NamedArray>& arrays, Report& report, Progress& progress);

} // namespace tetvdb
