// SPDX-License-Identifier: Apache-2.0
//
// The tile files of a layer of a child of the root node, on their way from trees that come part by
// part: what will be in them waits, compressed, until all parts have come.
#pragma once

#include "tetvdb/geometry/NodeBox.h"
#include "tetvdb/io/volume/GridSpool.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <openvdb/openvdb.h>
#include <string>
#include <vector>

namespace tetvdb {

class TileSpools {
public:
  /// A file's grids, in their order.
  using Spools = std::vector<std::unique_ptr<VdbSpool>>;

  /// `empty`: the grids without voxels. The layer begins at `corner` and is `size` voxels thick in
  /// x. The options say how much is in memory before a file without a name takes it.
  TileSpools(openvdb::GridPtrVec empty, const openvdb::Coord& corner, std::int32_t size,
             const SpoolOptions& options);

  /// What the grids have in `box`, a part of the layer; their nodes are taken from them. Boxes come
  /// in the order of nodes. Parallel. Throws as GridSpool::add() does.
  void add(const openvdb::GridPtrVec& parts, const NodeBox& box);
  /// Calls visit(corner, spools) for every file that holds anything, by y, then z. To be called
  /// once.
  void finish(const std::function<void(const openvdb::Coord&, Spools&)>& visit);

private:
  struct File {
    openvdb::Coord corner;
    Spools spools; ///< null: of a grid without anything
  };

  openvdb::GridPtrVec empty_;
  Vec3i cube_; ///< the origin of the root node's child
  std::int32_t size_;
  SpoolOptions options_;
  std::vector<File> files_; ///< by y, then z
};

} // namespace tetvdb
