// SPDX-License-Identifier: Apache-2.0
//
// .vdb files of grids whose whole trees never are in memory: values of any kind.
//
//   tetvdb::TreeVdbWriter writer("out.vdb", metadata, {});
//   std::vector<tetvdb::GridInfo> grids = writer.write(source, progress);
//   writer.commit(progress);
//
// Grids wait in files without names (io/volume/GridSpool.h) in the output's folder, which needs the
// room for them besides.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/volume/GridSpool.h"
#include "tetvdb/io/volume/VdbOutput.h"
#include "tetvdb/volume/TreeSource.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb {

struct TreeVdbOptions {
  /// Open the first tile of a grid without leaves, as openFirstTile() does.
  bool openFirstTile = true;
  SpoolOptions spool; ///< its folder is replaced
};

class TreeVdbWriter {
public:
  /// Throws as VdbOutput does.
  TreeVdbWriter(std::string path, std::map<std::string, std::string> metadata,
                const TreeVdbOptions& options);

  /// Writes all but the end; the bytes are those that writeVolume() would write. What describe()
  /// would say of the grids is returned. Memory: the trees of one part of the source, the bytes
  /// that the options allow, and a few MB a thread. Throws Error(Write), Error(Limit) where a grid
  /// would have 2^32 leaves or more, and as progress.check() does.
  std::vector<GridInfo> write(TreeSource& source, Progress& progress);
  void commit(Progress& progress);

private:
  std::string path_;
  std::map<std::string, std::string> metadata_;
  TreeVdbOptions options_;
  std::unique_ptr<VdbOutput> output_;
};

} // namespace tetvdb
