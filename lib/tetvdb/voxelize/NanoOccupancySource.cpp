// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/NanoOccupancySource.h"

#include "tetvdb/core/NanoVdb.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <utility>

namespace tetvdb {
namespace {

using Upper = nanovdb::NanoUpper<nanovdb::ValueMask>::DataType;
using Lower = nanovdb::NanoLower<nanovdb::ValueMask>::DataType;
using Leaf = nanovdb::NanoLeaf<nanovdb::ValueMask>::DataType;

template <typename Mask>
std::array<std::uint64_t, 64> wordsOf(const Mask& mask) {
  std::array<std::uint64_t, 64> words;
  static_assert(sizeof mask == sizeof words);
  std::memcpy(words.data(), &mask, sizeof words);
  return words;
}

std::unique_ptr<BitNode> nodeOf(const Lower& lower) {
  auto node = std::make_unique<BitNode>();
  node->children = wordsOf(lower.mChildMask);
  node->tiles = wordsOf(lower.mValueMask);
  node->leaves.resize(8 * countBits(node->children));
  std::uint64_t* to = node->leaves.data();
  for (std::uint32_t n = 0; n < 4096; ++n)
    if (lower.mChildMask.isOn(n)) {
      const Leaf& leaf = *lower.getChild(n)->data();
      std::memcpy(to, &leaf.mValueMask, sizeof leaf.mValueMask);
      to += 8;
    }
  return node;
}

// The node of the cube whose first voxel is `origin`; null where nothing is there.
const Upper* findUpper(const unsigned char* column, const Vec3i& origin) {
  const auto& grid = *reinterpret_cast<const nanovdb::NanoGrid<nanovdb::ValueMask>*>(column);
  const auto& root = *grid.tree().root().data();
  for (std::uint32_t i = 0; i < root.mTableSize; ++i) {
    const auto* tile = root.tile(i);
    const auto at = tile->origin();
    if (at[0] != origin[0] || at[1] != origin[1] || at[2] != origin[2])
      continue;
    if (tile->isValue())
      throw std::logic_error("a cube that is not full has no nodes");
    return root.getChild(tile)->data();
  }
  return nullptr;
}

} // namespace

NanoOccupancySource::NanoOccupancySource(std::vector<RootCube> cubes, MakeColumn makeColumn)
    : cubes_(std::move(cubes)), makeColumn_(std::move(makeColumn)) {}

std::vector<int> NanoOccupancySource::begin(std::size_t cube) {
  const Vec3i& origin = cubes_.at(cube).origin;
  constexpr std::int32_t kSide = 4096;
  if (column_ == nullptr || origin[0] / kSide != x_ || origin[1] / kSide != y_) {
    x_ = origin[0] / kSide;
    y_ = origin[1] / kSide;
    column_ = makeColumn_(x_, y_);
  }
  const Upper* upper = findUpper(column_, origin);
  upper_ = upper;
  std::vector<int> stacks;
  if (upper == nullptr)
    return stacks;
  const auto* children = reinterpret_cast<const std::uint32_t*>(&upper->mChildMask);
  const auto* tiles = reinterpret_cast<const std::uint32_t*>(&upper->mValueMask);
  for (int stack = 0; stack < kStacksPerCube; ++stack) // a word each
    if ((children[stack] | tiles[stack]) != 0)
      stacks.push_back(stack);
  return stacks;
}

void NanoOccupancySource::fill(int stack, BitStack& out) {
  const Upper& upper = *static_cast<const Upper*>(upper_);
  for (int z = 0; z < kStackNodes; ++z) {
    const auto n = static_cast<std::uint32_t>(stack * kStackNodes + z);
    const auto at = static_cast<std::size_t>(z);
    if (upper.mChildMask.isOn(n)) {
      out.states[at] = NodeState::Mixed;
      out.nodes[at] = nodeOf(*upper.getChild(n)->data());
    } else {
      out.states[at] = upper.mValueMask.isOn(n) ? NodeState::Full : NodeState::Empty;
      out.nodes[at].reset();
    }
  }
}

} // namespace tetvdb
