// SPDX-License-Identifier: Apache-2.0
//
// The tets that own voxels, box by box.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/fields/Field.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/pipeline/SplitBox.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TetNodes.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Tets in their order, and what is found from them.
struct OwnerTets {
  const TetMesh* mesh = nullptr;
  const SnappedMesh* snapped = nullptr;
  const TetNodes* nodes = nullptr;
  const std::vector<Field>* fields = nullptr; ///< null: none are asked for
  /// Numbers of the mesh's cells; null: their places.
  const std::vector<std::uint32_t>* cellNumbers = nullptr;
};

class TetSource {
public:
  virtual ~TetSource() = default;
  /// Nodes that tets may have voxels in, ascending, and the leaves that each has at most.
  virtual std::size_t size() const = 0;
  virtual NodeIndex node(std::size_t i) const = 0;
  virtual std::size_t mostLeaves(std::size_t i) const = 0;
  /// Boxes that together are `cube`, a child of the root node, each node of one before each of the
  /// next; their tets are in memory at a time.
  virtual std::vector<SplitBox> boxes(const NodeBox& cube) const = 0;
  /// All tets that may own voxels of `box`, which lies in one of boxes(); of an empty box none are
  /// needed. Valid until the next call. Cheapest for one box after the other.
  virtual const OwnerTets& within(const NodeBox& box, Progress& progress) = 0;
};

/// Of a mesh in memory.
class WholeTets : public TetSource {
public:
  /// All but `progress` must outlive it. `fields` may be null.
  WholeTets(const TetMesh& mesh, const SnappedMesh& snapped, const std::vector<Field>* fields,
            Progress& progress)
      : nodes_(snapped, progress), tets_{&mesh, &snapped, &nodes_, fields, nullptr} {}

  std::size_t size() const override { return nodes_.size(); }
  NodeIndex node(std::size_t i) const override { return nodes_.node(i); }
  std::size_t mostLeaves(std::size_t i) const override { return nodes_.mostLeaves(i); }
  std::vector<SplitBox> boxes(const NodeBox& cube) const override { return {{cube, 0}}; }
  const OwnerTets& within(const NodeBox&, Progress&) override { return tets_; }

private:
  TetNodes nodes_;
  OwnerTets tets_;
};

} // namespace tetvdb
