// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/OffsetLevelSet.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <tbb/parallel_for.h>
#include <vector>

namespace tetvdb {

openvdb::FloatGrid::Ptr offsetLevelSet(const openvdb::FloatGrid& squared, double distance,
                                       OffsetKept kept, const GridTransform& transform) {
  using Tree = openvdb::FloatTree;
  using Leaf = Tree::LeafNodeType;
  const double bound = distance / transform.voxelSize[0];
  const auto valueOf = [&](float square) {
    const double v =
        std::clamp(bound - std::sqrt(static_cast<double>(square)), -kOffsetBand, kOffsetBand);
    return static_cast<float>(kept == OffsetKept::Farther ? v : -v);
  };
  const Tree& from = squared.constTree();
  auto grid = openvdb::FloatGrid::create(static_cast<float>(kOffsetBand)); // of the background
  auto tile = from.cbeginValueAll();
  for (tile.setMaxDepth(Tree::ValueAllCIter::LEAF_DEPTH - 1); tile; ++tile)
    if (const float value = valueOf(*tile); value < 0)
      grid->tree().addTile(tile.getLevel(), tile.getCoord(), value, false);
  std::vector<const Leaf*> leaves;
  from.getNodes(leaves);
  std::vector<std::unique_ptr<Leaf>> made(leaves.size());
  tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
    auto leaf = std::make_unique<Leaf>(leaves[i]->origin(), 0.0f, true);
    const float* squares = leaves[i]->buffer().data();
    float* values = leaf->buffer().data();
    for (openvdb::Index k = 0; k < Leaf::SIZE; ++k)
      values[k] = valueOf(squares[k]);
    made[i] = std::move(leaf);
  });
  for (auto& leaf : made)
    grid->tree().addLeaf(leaf.release());
  grid->setName("shape");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(makeTransform(transform));
  return grid;
}

} // namespace tetvdb
