// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/OpenedSource.h"

namespace tetvdb {

OpenedSource::OpenedSource(BitSource& source, const Vec3i& tile)
    : source_(source), cubes_(source.cubes()) {
  const auto within = [&](std::size_t k, std::int32_t size) {
    return static_cast<std::size_t>((tile[k] & 4095) / size);
  };
  for (std::size_t c = 0; c < cubes_.size(); ++c)
    if (cubes_[c].origin == Vec3i{tile[0] & ~4095, tile[1] & ~4095, tile[2] & ~4095})
      openedCube_ = c;
  openedStack_ = static_cast<int>(within(0, 128) * 32 + within(1, 128));
  openedNode_ = within(2, 128);
  openedEntry_ = (within(0, 8) & 15) << 8 | (within(1, 8) & 15) << 4 | (within(2, 8) & 15);
  cubes_[openedCube_].full = false;
}

std::vector<int> OpenedSource::begin(std::size_t cube) {
  cube_ = cube;
  if (!source_.cubes()[cube].full)
    return source_.begin(cube);
  std::vector<int> stacks(static_cast<std::size_t>(kStacksPerCube));
  for (std::size_t i = 0; i < stacks.size(); ++i)
    stacks[i] = static_cast<int>(i);
  return stacks;
}

void OpenedSource::fill(int stack, BitStack& out) {
  if (source_.cubes()[cube_].full)
    out.states.fill(NodeState::Full);
  else
    source_.fill(stack, out);
  if (cube_ != openedCube_ || stack != openedStack_)
    return;
  std::unique_ptr<BitNode>& node = out.nodes[openedNode_];
  if (out.states[openedNode_] == NodeState::Full) {
    node = std::make_unique<BitNode>();
    node->tiles.fill(~std::uint64_t(0));
  }
  out.states[openedNode_] = NodeState::Mixed;
  const std::uint64_t bit = std::uint64_t(1) << (openedEntry_ & 63);
  node->tiles[openedEntry_ >> 6] &= ~bit;
  node->children[openedEntry_ >> 6] |= bit;
  node->leaves.assign(8, ~std::uint64_t(0));
}

} // namespace tetvdb
