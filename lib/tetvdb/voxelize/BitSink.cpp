// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/BitSink.h"

#include "tetvdb/voxelize/LeafRows.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tetvdb {

// A node under construction. Leaves are added slab by slab.
struct BitSink::OpenNode : NodeSink::Node {
  NodeIndex index;
  std::unique_ptr<BitNode> bits = std::make_unique<BitNode>();
  std::array<std::pair<std::size_t, std::size_t>, kSlabsPerNode> slabs{}; // of bits->leaves
  int last = -1;
  bool inOrder = true;
};

std::unique_ptr<NodeSink::Node> BitSink::begin(const NodeIndex& index) {
  auto node = std::make_unique<OpenNode>();
  node->index = index;
  return node;
}

void BitSink::slab(Node& open, int index, const SlabBits& bits, const std::uint32_t*) {
  auto& node = static_cast<OpenNode&>(open);
  node.inOrder = node.inOrder && index > node.last;
  node.last = index;
  std::vector<std::uint64_t>& leaves = node.bits->leaves;
  const std::size_t first = leaves.size();
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
  node.slabs[static_cast<std::size_t>(index)] = {first, leaves.size()};
}

void BitSink::end(std::unique_ptr<Node> open) {
  auto& node = static_cast<OpenNode&>(*open);
  const auto z = static_cast<std::size_t>(node.index[2] - zFirst_);
  BitNode& bits = *node.bits;
  if (bits.leaves.empty()) {
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
  if (!node.inOrder) {
    std::vector<std::uint64_t> sorted;
    sorted.reserve(bits.leaves.size());
    for (const auto& [first, last] : node.slabs)
      sorted.insert(sorted.end(), bits.leaves.begin() + static_cast<std::ptrdiff_t>(first),
                    bits.leaves.begin() + static_cast<std::ptrdiff_t>(last));
    bits.leaves = std::move(sorted);
  }
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
