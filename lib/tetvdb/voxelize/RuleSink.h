// SPDX-License-Identifier: Apache-2.0
//
// Changes voxels whose centre is inside to those whose cube meets the solid, or lies in it.
#pragma once

#include "tetvdb/core/GroupItems.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/NodeIndex.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TouchedFace.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace tetvdb {

/// The faces that pass through the cubes of each 128^3 node's voxels.
class RuledFaces {
public:
  /// Both must outlive it. Parallel, 16 bytes for each face and node.
  RuledFaces(const SnappedMesh& mesh, const Boundary& faces, Progress& progress);

  /// Nodes with faces, numbered by x, then y, then z.
  std::size_t size() const { return pairs_.groupCount(); }
  const NodeIndex& node(std::size_t i) const { return pairs_.firstOf(i).node; }
  /// The number of the first node that is not before `node`.
  std::size_t lowerBound(const NodeIndex& node) const;
  void prepare(std::size_t i, std::vector<TouchedFace>& faces) const;

private:
  const SnappedMesh& mesh_;
  const Boundary& faces_;
  GroupedItems<NodeFace> pairs_;
};

/// Hands on what it receives, with the voxels whose cubes a face passes through (TouchedFace.h)
/// added, for VoxelRule::Any, or taken away, for VoxelRule::All. In a cube that no face passes
/// through the number of tets is the same everywhere, and so the centre's answer holds for all of
/// it; a face that does pass through has more tets on one side than on the other.
class RuleSink : public NodeSink {
public:
  /// Both must outlive it. Each node received is one of the faces' nodes from number `first` to
  /// `end`, or a node without faces.
  RuleSink(NodeSink& next, const RuledFaces& faces, VoxelRule rule, std::size_t first,
           std::size_t end);

  std::unique_ptr<Node> begin(const NodeIndex& node) override;
  void slab(Node& node, int index, const SlabBits& bits, const std::uint32_t* owners) override;
  void end(std::unique_ptr<Node> node) override;
  void fullRun(std::int32_t x, std::int32_t y, std::int32_t zBegin, std::int32_t zEnd) override;
  void fullNode(const NodeIndex& node, std::uint32_t owner) override;

  /// Call after the last node: passes on the nodes that faces pass through but no centre is in.
  /// Parallel.
  void finish();

private:
  struct RuledNode;
  static constexpr std::size_t kNoFaces = ~std::size_t(0);

  std::size_t find(const NodeIndex& node) const;
  bool touch(const RuledNode& node, int index, SlabBits& bits) const;
  void passOn(RuledNode& node, int index, const SlabBits* inside);

  NodeSink& next_;
  const RuledFaces& faces_;
  bool adds_;
  std::size_t first_;
  std::vector<std::uint8_t> seen_; ///< from first_ on, each written by the task of its node
};

} // namespace tetvdb
