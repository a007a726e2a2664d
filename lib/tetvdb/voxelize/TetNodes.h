// SPDX-License-Identifier: Apache-2.0
//
// Rasterises every tet: computes the owner of each voxel, and occupancy where tets are about a
// voxel wide.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/NodeBox.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TetRaster.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

namespace tetvdb {

/// Tets assigned to the slabs that they may have voxels in, nodes that a tet fills apart.
class TetNodes {
public:
  /// `mesh` must outlive it. Parallel; 4 bytes a pair of tet and slab, four times that meanwhile.
  TetNodes(const SnappedMesh& mesh, Progress& progress);
  ~TetNodes();
  TetNodes(const TetNodes&) = delete;
  TetNodes& operator=(const TetNodes&) = delete;

  /// Nodes with tets, ascending.
  std::size_t size() const;
  const NodeIndex& node(std::size_t i) const;
  /// Leaves that node `i` has at most.
  std::size_t mostLeaves(std::size_t i) const;

  /// Hands every node of `box` that is not empty to `sink`: with owners (lowest tet index wins) or
  /// bits alone. One task a node, its slabs apart where nodes are few.
  void rasterize(const NodeBox& box, bool owners, NodeSink& sink, Progress& progress) const;
  /// The same of all nodes. Returns how many tets were reversed or dropped.
  OrientationCounts rasterize(bool owners, NodeSink& sink, Progress& progress) const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// A bit a slab of a node, and one for a tet that fills all of it.
constexpr std::uint32_t kWholeNodeBit = std::uint32_t(1) << kSlabsPerNode;

/// Calls visit(node, slabs) for every node that TetNodes finds for the tet, once each. Throws
/// Error(Limit) for a tet longer than kMaxTetExtent.
void eachNodeOf(const SnappedMesh& mesh, std::size_t tet,
                const std::function<void(const NodeIndex&, std::uint32_t)>& visit);
/// TetNodes::mostLeaves() of a node of whose slabs those have tets.
std::size_t mostLeavesOf(std::uint32_t slabs);

/// How many tets are reversed or dropped.
OrientationCounts countOrientations(const SnappedMesh& mesh);

/// Hands every node that is not empty to `sink`, as TetNodes::rasterize() does.
OrientationCounts rasterizeNodes(const SnappedMesh& mesh, bool owners, NodeSink& sink,
                                 Progress& progress);

} // namespace tetvdb
