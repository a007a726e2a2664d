// SPDX-License-Identifier: Apache-2.0
//
// Functions that the writers of array formats (io/volume/arrays/ArrayFormats.h) share. Internal.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/volume/arrays/ArrayFormats.h"
#include "tetvdb/io/volume/arrays/DenseGrid.h"

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb {

/// The content of one file: grids of one box and one transform.
struct ArrayContent {
  std::string path;
  std::vector<std::unique_ptr<DenseGrid>> grids;
  std::vector<std::string> names; ///< of the grids, none twice, no control characters, no slashes
  VoxelBox box;
  /// World from index, row by row; the last row is 0 0 0 1.
  std::array<double, 16> transform{};
  std::map<std::string, std::string> metadata;
  bool compress = false;
  bool sparse = false;

  /// Lengths of the transform's first three columns: a voxel's sides, world units.
  Vec3d voxelSize() const;
  /// World position of a voxel's centre.
  Vec3d worldOf(const Vec3d& index) const;
  /// Whether the axes of index space are those of world space.
  bool isAxisAligned() const;
  /// Throws Error(Usage) unless isAxisAligned(); `format` is named in the text.
  void requireAxisAligned(const char* format) const;
  /// Throws Error(Usage) unless there is one grid.
  void requireOneGrid(const char* format) const;
};

/// Sends planes of grids to a writer, in order, some MB at a time, with progress over all of them.
class ArrayStream {
public:
  using Sink = std::function<void(const char* bytes, std::size_t size)>;

  /// `passes`: how often each of the content's grids is sent.
  ArrayStream(const ArrayContent& content, Progress& progress, int passes = 1);

  void send(const DenseGrid& grid, const AxisOrder& order, const Sink& sink);
  /// The same for active voxels: their coordinates (int32 x, y, z), or their values.
  void sendVoxels(const DenseGrid& grid, const Sink& sink);
  void sendValues(const DenseGrid& grid, const Sink& sink);

private:
  void update(double bytes);

  Progress& progress_;
  double total_ = 0, done_ = 0;
};

} // namespace tetvdb
