// SPDX-License-Identifier: Apache-2.0
//
// The folder that io/TileFiles.h describes, on its way: from trees, or from bits without a tree.
#pragma once

#include "tetvdb/core/AtomicFolder.h"
#include "tetvdb/core/ProgressShare.h"
#include "tetvdb/io/TileFiles.h"
#include "tetvdb/io/volume/BitVdbWriter.h"
#include "tetvdb/volume/BitSource.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/TreeSource.h"

#include <map>
#include <string>
#include <vector>

namespace tetvdb {

class TileFolder {
public:
  /// `grids`: with names, types, classes and transforms; their trees are not used. `metadata`: of
  /// every file. `levels`: that every file gets of what it holds. Throws as writeTileFiles() does.
  TileFolder(const std::string& folder, int size, std::map<std::string, std::string> metadata,
             const openvdb::GridPtrVec& grids, const TileLevels& levels = {});

  /// Writes what `parts`, trees of the grids in their order, have in the child of the root node at
  /// `origin`. Memory: that of one file's nodes.
  void add(const openvdb::GridPtrVec& parts, const openvdb::Coord& origin, Progress& progress);
  /// Writes the voxels of a source, of grids that BitVdbWriter takes. Memory: as BitVdbWriter's,
  /// and 32 MB where the files' cubes are smaller than the root's children, beyond which nodes wait
  /// in a file without a name.
  void add(BitSource& source, const BitVdbOptions& options, Progress& progress);
  /// Writes the grids of a source, in their order. Memory: the trees of one of its parts, those of
  /// the levels of a layer of files, and `inMemory` bytes, beyond which the files of a layer wait
  /// in one without a name.
  void add(TreeSource& source, std::size_t inMemory, const ProgressShare& share,
           Progress& progress);

  /// Writes tiles.json and gives the folder its name.
  TileFilesInfo commit(Progress& progress);
  /// What the files hold so far.
  const std::vector<GridInfo>& grids() const { return grids_; }

private:
  struct File {
    std::string name, hash;
    Vec3i origin;
    std::uint64_t bytes = 0;
    std::vector<GridInfo> grids;
  };

  class Layer;

  void requireRoom(std::size_t files) const;
  std::string nextPath() const;
  void finish(const Vec3i& origin, std::vector<GridInfo> infos);
  void addCube(BitSource& source, const Vec3i& origin, const BitVdbOptions& options,
               Progress& progress);
  std::string index() const;

  std::int32_t size_;
  std::map<std::string, std::string> metadata_;
  TileLevels levels_;
  std::size_t own_;             ///< grids that are no levels
  openvdb::GridPtrVec empty_;   ///< all grids without voxels, levels last
  std::vector<GridInfo> grids_; ///< sums
  std::vector<File> files_;
  AtomicFolder folder_;
};

} // namespace tetvdb
