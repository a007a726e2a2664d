// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/StoredNodes.h"

#include <algorithm>
#include <memory>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kMaskBytes = 64 * sizeof(std::uint64_t);
constexpr std::size_t kLeafBytes = 8 * sizeof(std::uint64_t);
static_assert(2 * kMaskBytes + 4096 * kLeafBytes <= TailStore::kChunk, "a node is one piece");

std::size_t placeOf(int stack, int z) {
  return static_cast<std::size_t>(stack) * kStackNodes + static_cast<std::size_t>(z);
}

} // namespace

StoredNodes::StoredNodes(BitSource& source, std::size_t cube, const std::string& folder,
                         std::size_t inMemory, Progress& progress)
    : origin_(source.cubes()[cube].origin), store_(folder, inMemory) {
  places_.resize(static_cast<std::size_t>(kStacksPerCube) * kStackNodes);
  if (source.cubes()[cube].full) {
    for (Place& place : places_)
      place.state = NodeState::Full;
    return;
  }
  const std::vector<int> stacks = source.begin(cube);
  tbb::parallel_for(std::size_t(0), stacks.size(), [&](std::size_t i) {
    progress.check();
    BitStack bits;
    source.fill(stacks[i], bits);
    for (int z = 0; z < kStackNodes; ++z) {
      Place& place = places_[placeOf(stacks[i], z)];
      place.state = bits.states[static_cast<std::size_t>(z)];
      if (place.state == NodeState::Mixed)
        keep(*bits.nodes[static_cast<std::size_t>(z)], place);
    }
  });
}

void StoredNodes::keep(const BitNode& node, Place& place) {
  std::string bytes;
  bytes.reserve(2 * kMaskBytes + node.leaves.size() * sizeof(std::uint64_t));
  const auto add = [&](const auto& words) {
    bytes.append(reinterpret_cast<const char*>(words.data()), words.size() * sizeof words[0]);
  };
  add(node.children);
  add(node.tiles);
  add(node.leaves);
  place.leaves = static_cast<std::uint32_t>(node.leaves.size() / 8);
  place.at = store_.add(bytes.data(), bytes.size());
}

StoredNodes::Part::Part(const StoredNodes& nodes, const Vec3i& origin, std::int32_t size)
    : nodes_(nodes), zBegin_((origin[2] - nodes.origin_[2]) / 128),
      zEnd_(zBegin_ + size / 128), cubes_{{nodes.origin_, false}} {
  const int xBegin = (origin[0] - nodes.origin_[0]) / 128;
  const int yBegin = (origin[1] - nodes.origin_[1]) / 128;
  for (int x = xBegin; x < xBegin + size / 128; ++x)
    for (int y = yBegin; y < yBegin + size / 128; ++y) {
      const int stack = x * kStackNodes + y;
      for (int z = zBegin_; z < zEnd_; ++z)
        if (nodes_.places_[placeOf(stack, z)].state != NodeState::Empty) {
          stacks_.push_back(stack);
          break;
        }
    }
}

void StoredNodes::Part::fill(int stack, BitStack& out) {
  for (int z = zBegin_; z < zEnd_; ++z) {
    const Place& place = nodes_.places_[placeOf(stack, z)];
    const auto i = static_cast<std::size_t>(z);
    out.states[i] = place.state;
    if (place.state != NodeState::Mixed)
      continue;
    std::string bytes(2 * kMaskBytes + place.leaves * kLeafBytes, '\0');
    nodes_.store_.read(place.at, bytes.data(), bytes.size());
    auto node = std::make_unique<BitNode>();
    node->leaves.resize(std::size_t(place.leaves) * 8);
    auto take = [at = bytes.data()](auto& words) mutable {
      const std::size_t size = words.size() * sizeof words[0];
      std::copy_n(at, size, reinterpret_cast<char*>(words.data()));
      at += size;
    };
    take(node->children);
    take(node->tiles);
    take(node->leaves);
    out.nodes[i] = std::move(node);
  }
}

} // namespace tetvdb
