// SPDX-License-Identifier: Apache-2.0
//
// The tets of a spooled mesh by the boxes of nodes that they meet.
#pragma once

#include "tetvdb/core/FileSpool.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/SpooledMesh.h"
#include "tetvdb/pipeline/SplitBox.h"
#include "tetvdb/pipeline/prepared/PreparedFiles.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

class TetBuckets {
public:
  /// Finds the nodes that tets meet (with arrays also those of tets that meet no voxel, whose
  /// values count for ranges), cuts their cubes into boxes of at most `mostTets` tets where nodes
  /// allow it, and lists the tets of each in a temporary file in `folder`. Passes over the mesh
  /// twice. All but `progress` must outlive it. Memory: 100 bytes a node met, and as many lists
  /// under way as `bytes` allows, of 1 KB at least. Throws Error(Write), Error(Limit).
  TetBuckets(const SpooledMesh& mesh, const GridTransform& transform, std::uint64_t mostTets,
             const std::string& folder, std::size_t bytes, std::size_t maxResident,
             Progress& progress);

  const std::vector<MetNode>& nodes() const { return nodes_; } ///< ascending
  const std::vector<SplitBox>& boxes() const { return boxes_; }
  std::uint64_t tetsIn(std::size_t box) const { return lists_[box].count; }
  /// The tets of a box in the mesh's order.
  BucketTets tets(std::size_t box) const;

private:
  /// Tets whose numbers lie in `lists`, in pieces.
  struct List {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> pieces; ///< number of the first, count
    std::vector<std::uint32_t> last;                             ///< not yet there
    std::uint64_t count = 0;
  };

  void findNodes();
  void findBoxes(std::uint64_t mostTets);
  void listTets(std::size_t bytes);
  void flush(List& list);
  void gather(const void* from, std::size_t size, const std::vector<std::uint32_t>& places,
              void* to) const;
  std::size_t findNode(const NodeIndex& node) const;
  template <typename Visit>
  void eachNode(const SnappedMesh& mesh, std::size_t tet, const Visit& visit) const;
  void addShapes(const std::vector<std::uint32_t>& cells, TetMesh& mesh) const;

  const SpooledMesh& mesh_;
  const GridTransform& transform_;
  std::size_t maxResident_;
  Progress& progress_;
  std::vector<MetNode> nodes_;
  std::vector<std::uint32_t> tetsOf_; ///< of each node, for the boxes
  std::vector<std::uint32_t> boxOfNode_;
  std::vector<SplitBox> boxes_; ///< by cube, then in a file's order
  std::vector<List> lists_;
  FileSpool spool_;
};

} // namespace tetvdb
