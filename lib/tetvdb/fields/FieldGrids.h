// SPDX-License-Identifier: Apache-2.0
//
// The grids of all fields, built leaf by leaf from the owners of the voxels: a sink for
// voxelize/TetNodes.h. Internal.
#pragma once

#include "tetvdb/fields/Field.h"
#include "tetvdb/io/volume/PackedGrid.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace tetvdb::nano {
struct LeafBatch; // nanovdb_kernels/FieldJob.h
}

namespace tetvdb {

/// Bytes of a leaf of a field's grid, including allocation.
std::size_t leafBytes(FieldKind kind);

class FieldGrids : public NodeSink {
public:
  FieldGrids(const TetMesh& mesh, const SnappedMesh& snapped, const GridTransform& transform,
             const std::vector<Field>& fields);
  /// Packs every leaf at once: grids are added to `packed`, an entry per field with its store set.
  FieldGrids(const TetMesh& mesh, const SnappedMesh& snapped, const GridTransform& transform,
             const std::vector<Field>& fields, bool asHalf,
             const std::vector<std::unique_ptr<PackedGrid>>& packed);
  ~FieldGrids() override;

  std::unique_ptr<Node> begin(const NodeIndex& node) override;
  void slab(Node& node, int index, const SlabBits& bits, const std::uint32_t* owners) override;
  void end(std::unique_ptr<Node> node) override;
  void fullRun(std::int32_t x, std::int32_t y, std::int32_t zBegin, std::int32_t zEnd) override;
  void fullNode(const NodeIndex& node, std::uint32_t owner) override;

  /// Adds leaves with values computed elsewhere, one entry of `batch.values` per field; replaces
  /// the functions of the sink. Batches contain whole nodes.
  void take(const nano::LeafBatch& batch);

  /// Returns the finished grids, also packed ones. Is called once, after the last node.
  openvdb::GridPtrVec finish(const GridTransform& transform);
  /// Number of voxels omitted from field `i` because their values are not finite.
  std::size_t leftOut(std::size_t i) const;
  /// Voxels in linear cells with shape functions that have values of their tets (LeafShapes.h).
  std::size_t byTets() const;
  /// Whether any voxel had an owner.
  bool any() const;

private:
  class GridBuilder;
  template <typename TreeType>
  class TypedBuilder;
  struct FieldNode;
  void addBuilder(const Field& field, const TetMesh& mesh, bool asHalf, PackedGrid* packed);
  struct Scratch;
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace tetvdb
