// SPDX-License-Identifier: Apache-2.0
//
// .vdb and .nvdb files of grids whose whole trees never are in memory: values of any kind.
//
//   tetvdb::TreeVdbWriter writer("out.vdb", metadata, {});
//   std::vector<tetvdb::GridInfo> grids = writer.write(source, share, progress);
//   writer.commit(progress);
//
// Grids wait in files without names (io/volume/GridSpool.h) in the output's folder, which needs the
// room for them besides.
#pragma once

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/io/volume/GridSpool.h"
#include "tetvdb/io/volume/VdbOutput.h"
#include "tetvdb/volume/TreeSource.h"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb {

struct TreeWriterOptions {
  /// Open the first tile of a grid without leaves, as openFirstTile() does.
  bool openFirstTile = true;
  std::size_t moreGrids = 0; ///< that come after those of the source, of any types
  SpoolOptions spool;        ///< its folder is replaced
};

class TreeWriter {
public:
  using MoreGrids = std::function<openvdb::GridPtrVec()>;

  virtual ~TreeWriter() = default;
  /// Writes all but the end, within `share`; the bytes are those that writeVolume() would write.
  /// `more`: the grids that come after, called when the source has given all of its own. What
  /// describe() would say of all grids is returned. Memory: the trees of one part of the
  /// source, the bytes that the options allow, and a few MB a thread. Throws Error(Write),
  /// Error(Limit) where a grid would have 2^32 leaves or more, and as progress.check() does.
  virtual std::vector<GridInfo> write(TreeSource& source, const MoreGrids& more,
                                      const ProgressShare& share, Progress& progress) = 0;
  virtual void commit(Progress& progress) = 0;
};

class TreeVdbWriter : public TreeWriter {
public:
  /// Throws as VdbOutput does.
  TreeVdbWriter(std::string path, std::map<std::string, std::string> metadata,
                const TreeWriterOptions& options);
  std::vector<GridInfo> write(TreeSource& source, const MoreGrids& more, const ProgressShare& share,
                              Progress& progress) override;
  void commit(Progress& progress) override;

private:
  std::string path_;
  std::map<std::string, std::string> metadata_;
  TreeWriterOptions options_;
  std::unique_ptr<VdbOutput> output_;
};

/// Besides, write() throws Error(Usage) for grids that .nvdb files cannot hold.
class TreeNvdbWriter : public TreeWriter {
public:
  /// Throws as AtomicFile does.
  TreeNvdbWriter(const std::string& path, const TreeWriterOptions& options);
  std::vector<GridInfo> write(TreeSource& source, const MoreGrids& more, const ProgressShare& share,
                              Progress& progress) override;
  void commit(Progress& progress) override;

private:
  TreeWriterOptions options_;
  AtomicFile file_;
};

} // namespace tetvdb
