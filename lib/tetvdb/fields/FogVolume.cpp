// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/FogVolume.h"

#include "tetvdb/geometry/NarrowBand.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

using Tree = openvdb::FloatTree;
using Leaf = Tree::LeafNodeType;
using Upper = Tree::RootNodeType::ChildNodeType;
using Lower = Upper::ChildNodeType;

// The fog of a leaf; false if it is 0 throughout.
bool makeLeafFog(Leaf& leaf, float weight) {
  float* values = leaf.buffer().data();
  bool any = false;
  for (openvdb::Index x = 0; x < 8; ++x) {
    std::uint64_t active = 0;
    for (openvdb::Index i = 0; i < 64; ++i) {
      float& value = values[64 * x + i];
      value = fogOf(value, weight);
      active |= static_cast<std::uint64_t>(value > 0) << i;
    }
    leaf.getValueMask().getWord<openvdb::Index64>(x) = active;
    any = any || active != 0;
  }
  return any;
}

// The fog of a node, whose leaves it takes; null if it is 0 throughout.
std::unique_ptr<Lower> fogOfNode(Lower& node, float background, float weight) {
  std::vector<Leaf*> leaves;
  node.stealNodes(leaves, background, false);
  auto fog = std::make_unique<Lower>(node.origin(), 0.0F, false);
  for (Leaf* leaf : leaves) {
    if (makeLeafFog(*leaf, weight))
      fog->addLeaf(leaf);
    else
      delete leaf;
  }
  for (auto tile = node.cbeginValueAll(); tile; ++tile)
    if (*tile < 0)
      fog->addTile(tile.pos(), 1.0F, true);
  return fog->getChildMask().isOff() && fog->getValueMask().isOff() ? nullptr : std::move(fog);
}

} // namespace

float fogDepth(const openvdb::FloatGrid& levelSet) {
  std::vector<const Lower*> nodes;
  levelSet.constTree().getNodes(nodes);
  const auto smallest = [&](const auto& ofNode) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, nodes.size()), std::numeric_limits<float>::max(),
        [&](const auto& range, float least) {
          for (std::size_t i = range.begin(); i != range.end(); ++i)
            least = std::min(least, ofNode(*nodes[i]));
          return least;
        },
        [](float a, float b) { return std::min(a, b); });
  };
  const float ofTiles = smallest([](const Lower& node) {
    float least = std::numeric_limits<float>::max();
    for (auto tile = node.cbeginValueAll(); tile; ++tile)
      least = std::min(least, *tile);
    return least;
  });
  if (ofTiles < 0)
    return ofTiles;
  return smallest([](const Lower& node) {
    float least = std::numeric_limits<float>::max();
    for (auto leaf = node.cbeginChildOn(); leaf; ++leaf) {
      const float* values = leaf->buffer().data();
      least = std::min(least, *std::min_element(values, values + Leaf::SIZE));
    }
    return least;
  });
}

void makeFog(openvdb::FloatGrid& levelSet, float depth) {
  Tree& from = levelSet.tree();
  const float background = from.background(), weight = 1 / depth;
  std::vector<Lower*> lowers;
  from.getNodes(lowers);
  std::vector<std::unique_ptr<Lower>> fogs(lowers.size());
  tbb::parallel_for(std::size_t(0), lowers.size(),
                    [&](std::size_t i) { fogs[i] = fogOfNode(*lowers[i], background, weight); });

  auto tree = std::make_shared<Tree>(0.0F);
  std::size_t next = 0; // of fogs, in the order of the nodes
  for (auto child = from.root().beginChildOn(); child; ++child) {
    auto upper = std::make_unique<Upper>(child->origin(), 0.0F, false);
    for (auto tile = child->cbeginValueAll(); tile; ++tile)
      if (*tile < 0)
        upper->addTile(tile.pos(), 1.0F, true);
    for (auto lower = child->cbeginChildOn(); lower; ++lower) {
      std::unique_ptr<Lower>& fog = fogs[next++];
      if (fog)
        upper->addChild(fog.release());
    }
    if (!upper->getChildMask().isOff() || !upper->getValueMask().isOff())
      tree->root().addChild(upper.release());
  }
  for (auto tile = from.root().cbeginValueAll(); tile; ++tile)
    if (*tile < 0)
      tree->root().addTile(tile.getCoord(), 1.0F, true);
  levelSet.setTree(tree);
  levelSet.setGridClass(openvdb::GRID_FOG_VOLUME);
  levelSet.setName("fog");
}

} // namespace tetvdb
