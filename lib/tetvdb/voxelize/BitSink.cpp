// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/BitSink.h"

#include "tetvdb/voxelize/LeafRows.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tetvdb {

// A node under construction.
struct BitSink::OpenNode : NodeSink::Node {
  NodeIndex index;
  std::unique_ptr<BitNode> bits = std::make_unique<BitNode>();
  std::array<std::vector<std::uint64_t>, kSlabsPerNode> leaves; // by slab
};

std::unique_ptr<NodeSink::Node> BitSink::begin(const NodeIndex& index) {
  auto node = std::make_unique<OpenNode>();
  node->index = index;
  return node;
}

void BitSink::slab(Node& open, int index, const SlabBits& bits, const std::uint32_t*) {
  auto& node = static_cast<OpenNode&>(open);
  std::vector<std::uint64_t>& leaves = node.leaves[static_cast<std::size_t>(index)];
  eachLeaf(bits, index, [&](const LeafRows& rows, int, int leafZ, int entry) {
    const auto word = static_cast<std::size_t>(entry >> 6);
    const std::uint64_t bit = std::uint64_t(1) << (entry & 63);
    if (rows.full(leafZ)) {
      node.bits->tiles[word] |= bit;
      return;
    }
    node.bits->children[word] |= bit;
    for (int x = 0; x < kLeafSize; ++x)
      leaves.push_back(rows.word(leafZ, x));
  });
}

void BitSink::end(std::unique_ptr<Node> open) {
  auto& node = static_cast<OpenNode&>(*open);
  const auto z = static_cast<std::size_t>(node.index[2] - zFirst_);
  BitNode& bits = *node.bits;
  std::size_t words = 0;
  for (const std::vector<std::uint64_t>& slab : node.leaves)
    words += slab.size();
  if (words == 0) {
    const auto isAll = [&](std::uint64_t word) {
      return std::all_of(bits.tiles.begin(), bits.tiles.end(),
                         [word](std::uint64_t tiles) { return tiles == word; });
    };
    if (isAll(0))
      return;
    if (isAll(~std::uint64_t(0))) {
      stack_.states[z] = NodeState::Full;
      return;
    }
  }
  bits.leaves.reserve(words);
  for (const std::vector<std::uint64_t>& slab : node.leaves)
    bits.leaves.insert(bits.leaves.end(), slab.begin(), slab.end());
  stack_.states[z] = NodeState::Mixed;
  stack_.nodes[z] = std::move(node.bits);
}

void BitSink::fullRun(std::int32_t, std::int32_t, std::int32_t zBegin, std::int32_t zEnd) {
  for (std::int32_t z = zBegin; z < zEnd; ++z)
    stack_.states[static_cast<std::size_t>(z - zFirst_)] = NodeState::Full;
}

void BitSink::fullNode(const NodeIndex& node, std::uint32_t) {
  fullRun(node[0], node[1], node[2], node[2] + 1);
}

} // namespace tetvdb
