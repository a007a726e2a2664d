// SPDX-License-Identifier: Apache-2.0
//
// Builds OpenVDB trees from rasterised nodes. Every 128^3 node is built by the task that rasterises
// it, without locks, merging and accessors.
#pragma once

#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tetvdb {

/// Bytes of a leaf node of that kind of grid, allocation included.
std::size_t leafBytes(GridKind kind);
/// Bytes of a lower internal node.
constexpr std::size_t kLowerNodeBytes = 33824;

/// A sink that builds one grid for each kind. Full nodes become tiles at 8^3, 128^3 and 4096^3, and
/// so do nodes whose voxels all have one value. Kinds that need owners (GridKind::TetId, Material)
/// must be fed with them.
class TreeBuilder : public NodeSink {
public:
  /// `cellNumbers`: what tet_id holds in place of a cell's place in the mesh; null: that.
  TreeBuilder(const std::vector<GridKind>& kinds, const TetMesh& mesh,
              const std::vector<std::uint32_t>* cellNumbers = nullptr);
  ~TreeBuilder() override;

  std::unique_ptr<Node> begin(const NodeIndex& node) override;
  void slab(Node& node, int index, const SlabBits& bits, const std::uint32_t* owners) override;
  void end(std::unique_ptr<Node> node) override;
  void fullRun(std::int32_t x, std::int32_t y, std::int32_t zBegin, std::int32_t zEnd) override;
  void fullNode(const NodeIndex& node, std::uint32_t owner) override;

  /// The finished grids, named, classed and with `transform`; call once, after the last node.
  openvdb::GridPtrVec finish(const GridTransform& transform);

private:
  class GridBuilder;
  struct TreeNode;
  template <typename TreeType, typename Fill>
  class TypedBuilder;
  std::vector<std::unique_ptr<GridBuilder>> builders_;
};

} // namespace tetvdb
