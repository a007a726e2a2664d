// SPDX-License-Identifier: Apache-2.0
//
// Computes occupancy from faces: along each z column the signed crossings of the faces are summed,
// and the sum decides which voxels are inside. Interior faces of tets cancel exactly under the
// ownership rule, so with the boundary of tets this is their union, voxel by voxel; with a closed
// triangle soup the sum is its winding number; with an open one the solid angles of the triangles
// over its holes are added (WindingBand.h).
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/FillRule.h"
#include "tetvdb/geometry/TriangleClusters.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tetvdb {

/// An upper estimate of the number of leaf nodes that the boundary passes through.
std::uint64_t estimateBoundaryLeaves(const SnappedMesh& mesh, const Boundary& boundary);

struct FillOptions {
  FillRule rule = FillRule::Positive;
  /// The triangles that fill the holes of an open soup (fillHoles()); null where the faces close.
  /// FillRule::Odd ignores them; every edge must then have an even number of faces.
  const TriangleClusters* holes = nullptr;
};

/// The sums of a stack of nodes at one height, in the smallest form that holds them.
struct BoundaryCarry {
  std::int32_t sum = 0;            ///< of all columns, where the following are empty
  std::vector<std::uint64_t> bits; ///< of each column: 0 or 1
  std::vector<std::int32_t> sums;  ///< of each column
  std::vector<std::int32_t> rests; ///< of each column (SlabCarry), where there are any
  std::vector<std::int32_t> holes;
};

/// Stacks of 128^3 nodes along z. Each can be rasterised on its own, from any height.
class BoundaryStacks {
public:
  /// Finds the nodes that faces meet, in parallel: 16 bytes a pair of face and node. All must
  /// outlive it. Throws as progress.check() does, and Error(Limit) for 2^32 faces or more.
  BoundaryStacks(const SnappedMesh& mesh, const Boundary& boundary, const FillOptions& fill,
                 Progress& progress);
  ~BoundaryStacks();
  BoundaryStacks(const BoundaryStacks&) = delete;
  BoundaryStacks& operator=(const BoundaryStacks&) = delete;

  /// A stack that faces meet: its place in units of nodes.
  struct Column {
    std::int32_t x, y;
    std::int32_t zBegin, zEnd; ///< above zEnd nothing is inside, below zBegin neither
    std::size_t begin, end;    ///< in the pairs of faces and nodes
  };
  /// By x, then y.
  const std::vector<Column>& columns() const { return columns_; }

  /// Hands the nodes zBegin <= z < zEnd of a column to `sink`: those that faces meet slab by slab,
  /// full ones between them as runs. `carry` holds the sums at zBegin, which are 0 up to the
  /// column's zBegin, and receives those at zEnd. Without a sink only the sums are computed.
  /// Several threads work on the slabs of a node where columns are few or values of the winding
  /// number needed. Thread-safe.
  void rasterize(const Column& column, std::int32_t zBegin, std::int32_t zEnd, BoundaryCarry& carry,
                 NodeSink* sink) const;

  /// Nodes of a column that faces meet, zBegin <= z < zEnd.
  std::size_t countNodes(const Column& column, std::int32_t zBegin, std::int32_t zEnd) const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
  std::vector<Column> columns_;
};

/// Hands every node that is not empty to `sink`: those that faces meet slab by slab, full ones
/// between them as runs. A stack of nodes along z is one task, since the sums are carried from node
/// to node; nodes that no face meets cost nothing. Time follows the number of columns that faces
/// cross and of nodes that they meet, and for open soups the area over which the winding number
/// passes a half off the faces.
void rasterizeBoundary(const SnappedMesh& mesh, const Boundary& boundary, const FillOptions& fill,
                       NodeSink& sink, Progress& progress);

} // namespace tetvdb
