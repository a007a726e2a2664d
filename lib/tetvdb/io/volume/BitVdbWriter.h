// SPDX-License-Identifier: Apache-2.0
//
// Writes .vdb files of grids that are never in memory as trees: occupancy of any resolution.
//
//   tetvdb::BitVdbWriter writer("out.vdb", metadata, {mask, density}, {});   // empty grids
//   std::vector<tetvdb::GridInfo> grids = writer.write(source, progress);
//   writer.commit(progress);
//
// Root children are written in file order. Their topology is written as soon as it is known,
// through an unnamed temporary file where that of a child is large. The leaves' buffers are made
// from the topology, which is read back.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/volume/BitCodec.h"
#include "tetvdb/io/volume/VdbOutput.h"
#include "tetvdb/volume/BitSource.h"
#include "tetvdb/volume/Grids.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

struct BitVdbOptions {
  /// Open the first tile of a volume without leaves, as openFirstTile() does.
  bool openFirstTile = true;
  bool part = false;      ///< the grids say how many leaves they have (PartMetadata.h)
  std::size_t window = 0; ///< stacks of nodes that are under way at most; 0: four a thread
  std::size_t spoolBytes = std::size_t(32) << 20; ///< of topology in memory before it goes to disk
  std::size_t moreGrids = 0; ///< that come after those of the source, of any types
};

class BitVdbWriter {
public:
  /// `grids`: empty FloatGrids, BoolGrids or MaskGrids with name, class and transform, to be stored
  /// as half where they say so. All have the same active voxels. Throws as VdbOutput does, and
  /// Error(Usage) for other grids.
  BitVdbWriter(std::string path, std::map<std::string, std::string> metadata,
               openvdb::GridPtrVec grids, const BitVdbOptions& options);

  /// Writes all but the end; the bytes are those that writeVolume() would write. Returns the result
  /// that describe() would give for the grids. Memory: spoolBytes, twice 64 MB at most where a grid
  /// may get the entry file_delayed_load, and a few MB a thread. Throws Error(Write), Error(Limit)
  /// where a grid would have 2^32 leaves or more, which OpenVDB cannot count, and as
  /// progress.check() does.
  std::vector<GridInfo> write(BitSource& source, Progress& progress,
                              const std::function<openvdb::GridPtrVec()>& more = {});
  void commit(Progress& progress);

private:
  std::string path_;
  std::map<std::string, std::string> metadata_;
  openvdb::GridPtrVec grids_;
  BitVdbOptions options_;
  std::unique_ptr<VdbOutput> output_;
};

} // namespace tetvdb
