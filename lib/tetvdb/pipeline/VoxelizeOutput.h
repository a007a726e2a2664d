// SPDX-License-Identifier: Apache-2.0
//
// What a VoxelizeJob says about its grids, and its files.
#pragma once

#include "tetvdb/io/TileFiles.h"
#include "tetvdb/io/volume/NanoFile.h"
#include "tetvdb/io/volume/PackedGrid.h"
#include "tetvdb/pipeline/Preview.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <functional>
#include <memory>
#include <vector>

namespace tetvdb {

using PackedGrids = std::vector<std::unique_ptr<PackedGrid>>;

/// Those of the job's grids that addShapeGrids() adds, and how.
ShapeOptions shapesOf(const VoxelizeJob& job);

/// Grids that are made of arrays can have any values: throws Error(Invalid) for those beyond 16
/// bits where these are asked for, warns of those that Blender would not show.
void checkValues(const VoxelizeJob& job, const std::vector<GridInfo>& grids, Report& report);

struct VoxelizeOutput {
  Volume& volume;
  /// The device's grids, written as they are; the volume then has none.
  const std::vector<NanoBytes>& nano;
  const PackedGrids& packed; ///< that come after the volume's
  const Preview& preview;
};

/// Throws Error(Usage) for a folder whose name is that of a volume or array file, or that holds one
/// of the inputs, and as checkTileFiles() does.
void requireTileFolder(const std::string& folder, int size, const LevelRange& levels,
                       const std::vector<std::string>& inputs);

/// As addLevels(), with first tiles opened; what describe() says of the added grids.
std::vector<GridInfo> addDescribedLevels(Volume& volume, const LevelRange& levels,
                                         std::size_t maxMemory, Progress& progress);

/// Notes that they were written.
void addTileFiles(const TileFilesInfo& files, const std::string& folder, VoxelizeResult& result);

/// Writes the job's files: all of them, or none and what the failing one threw. writeMesh() writes
/// the mesh. The volume moves to `result` where the job keeps it. Adds stage "write" to `report`.
void writeOutputs(const VoxelizeJob& job, const VoxelizeOutput& output,
                  const std::function<void()>& writeMesh, VoxelizeResult& result, Report& report,
                  Progress& progress);

} // namespace tetvdb
