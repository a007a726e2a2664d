// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/volume/BitLevels.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace tetvdb {
namespace {

/// Voxels of the 4^3 cubes of 2^3 of a leaf, x slowest. In a word, one x slab, bit 8 y + z is that
/// of a voxel: pairs along z are added in fields of two bits, those of neighbouring slabs and rows
/// in fields of four.
template <class Cubes>
void countCubes(const std::uint64_t* words, Cubes& cubes) {
  constexpr std::uint64_t kPairs = 0x5555555555555555, kQuads = 0x3333333333333333,
                          kRows = 0x00FF00FF00FF00FF;
  for (std::size_t x = 0; x < 4; ++x) {
    std::uint64_t even = 0, odd = 0; // z / 2 of 0 and 2, of 1 and 3
    for (std::size_t i = 2 * x; i < 2 * x + 2; ++i) {
      const std::uint64_t pairs = (words[i] & kPairs) + (words[i] >> 1 & kPairs);
      even += pairs & kQuads;
      odd += pairs >> 2 & kQuads;
    }
    even = (even & kRows) + (even >> 8 & kRows);
    odd = (odd & kRows) + (odd >> 8 & kRows);
    for (std::size_t y = 0; y < 4; ++y)
      for (std::size_t z = 0; z < 4; ++z) {
        const std::uint64_t fields = (z & 1) == 0 ? even : odd;
        const double count = static_cast<double>(fields >> (16 * y + 4 * (z >> 1)) & 15);
        cubes[x * 16 + y * 4 + z] = {count, count};
      }
  }
}

} // namespace

BitLevels::BitLevels(BitSource& source, const LevelRange& levels, std::size_t maxMemory)
    : source_(source), levels_(levels), maxMemory_(maxMemory) {
  restart();
}

void BitLevels::restart() {
  builder_.emplace(levels_, LevelMean::OfAll, maxMemory_);
  cube_.reset();
  next_ = 0;
}

std::vector<int> BitLevels::begin(std::size_t cube) {
  if (cube < next_)
    restart();
  endCube();
  cube_ = cube;
  next_ = cube + 1;
  child_ = Builder::RootChild();
  return source_.begin(cube);
}

void BitLevels::fill(int stack, BitStack& out) {
  source_.fill(stack, out);
  const Vec3i& cube = source_.cubes()[*cube_].origin;
  for (int z = 0; z < kStackNodes; ++z) {
    const auto i = static_cast<std::size_t>(z);
    const std::size_t n = static_cast<std::size_t>(stack) * kStackNodes + i;
    if (out.states[i] == NodeState::Full) {
      child_.kinds[n] = EntryKind::Uniform;
      child_.voxels[n] = {1, 1};
    }
    if (out.states[i] != NodeState::Mixed)
      continue;
    const BitNode& node = *out.nodes[i];
    const std::uint64_t* leaf = node.leaves.data();
    child_.kinds[n] = EntryKind::Mixed;
    child_.nodes[n] =
        builder_->node(openvdb::Coord(cube[0] + stack / kStackNodes * 128,
                                      cube[1] + stack % kStackNodes * 128, cube[2] + z * 128),
                       [&](int entry, Builder::Entry& sums) {
                         const auto word = static_cast<std::size_t>(entry) >> 6;
                         const std::uint64_t bit = std::uint64_t(1) << (entry & 63);
                         if ((node.tiles[word] & bit) != 0) {
                           sums.voxel = {1, 1};
                           return EntryKind::Uniform;
                         }
                         if ((node.children[word] & bit) == 0)
                           return EntryKind::Nothing;
                         countCubes(leaf, sums.cubes);
                         leaf += 8;
                         return EntryKind::Mixed;
                       });
  }
}

void BitLevels::endCube() {
  if (!cube_)
    return;
  const Vec3i& origin = source_.cubes()[*cube_].origin;
  builder_->add(openvdb::Coord(origin.data()), std::move(child_));
  cube_.reset();
}

openvdb::GridPtrVec BitLevels::finish(const openvdb::GridPtrVec& grids) {
  endCube();
  for (const RootCube& cube : source_.cubes())
    if (cube.full) {
      Builder::RootChild full;
      std::fill(full.kinds.begin(), full.kinds.end(), EntryKind::Uniform);
      std::fill(full.voxels.begin(), full.voxels.end(), VoxelSum<double>{1, 1});
      builder_->add(openvdb::Coord(cube.origin.data()), std::move(full));
    }
  const auto trees = builder_->finish();
  openvdb::GridPtrVec levels;
  for (std::size_t g = 0; g < grids.size(); ++g)
    for (std::size_t i = 0; i < trees.size(); ++i) {
      // Grids that share a tree would become one grid and instances of it.
      const auto tree = g == 0 ? trees[i] : std::make_shared<openvdb::FloatTree>(*trees[i]);
      levels.push_back(levelGrid<openvdb::FloatTree>(
          tree, *grids[g], levels_.first + static_cast<int>(i), LevelMean::OfAll));
    }
  return levels;
}

} // namespace tetvdb
