// SPDX-License-Identifier: Apache-2.0
//
// Trees of the levels of detail of a grid (volume/LevelsOfDetail.h), made of its nodes one child of
// the root node at a time. A 128^3 node gives voxels of the levels up to 7 by itself: sums of 8^3
// voxels are added up eight by eight, level by level.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/LevelsOfDetail.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <openvdb/tools/Prune.h>
#include <utility>
#include <vector>

namespace tetvdb {

/// What is divided by what.
enum class LevelMean : std::uint8_t {
  OfAll,   ///< by the number of voxels that are covered
  OfActive ///< by the number of those that are active
};

/// Gives the grid of level k of `grid` its name, transform and metadata.
void finishLevelGrid(openvdb::GridBase& level, const openvdb::GridBase& grid, int k,
                     LevelMean mean);

/// Of active voxels.
template <class A>
struct VoxelSum {
  A sum{0.0};
  double active = 0;

  void add(const VoxelSum& o) {
    sum += o.sum;
    active += o.active;
  }
  VoxelSum times(double count) const { return {sum * count, active * count}; }
};

/// What an entry of a 128^3 node is, or such a node itself.
enum class EntryKind : std::uint8_t { Nothing, Uniform, Mixed };

/// Sums of the cubes of 2^3 within a cube, 2 Side along a side; x slowest.
template <std::size_t Side, class A>
std::array<VoxelSum<A>, Side * Side * Side> sumsOfEight(const VoxelSum<A>* fine) {
  constexpr std::size_t kFine = 2 * Side;
  std::array<VoxelSum<A>, Side * Side * Side> sums;
  for (std::size_t x = 0; x < kFine; ++x)
    for (std::size_t y = 0; y < kFine; ++y)
      for (std::size_t z = 0; z < kFine; ++z)
        sums[(x / 2 * Side + y / 2) * Side + z / 2].add(fine[(x * kFine + y) * kFine + z]);
  return sums;
}

/// `A`: what values are added up as.
template <class TreeT, class A>
class LevelBuilder {
public:
  using Leaf = typename TreeT::LeafNodeType;
  using T = typename TreeT::ValueType;
  using Sum = VoxelSum<A>;
  static constexpr int kNodes = 32; ///< 128^3 nodes along a child of the root node

  /// Sums of an entry of 8^3 voxels: of each of them, or of the 4^3 cubes of 2^3 in it, x slowest.
  struct Entry {
    Sum voxel;
    std::array<Sum, 64> cubes;
  };

  /// What a 128^3 node has of the levels.
  struct Node {
    struct Tile {
      int level;
      openvdb::Coord origin; ///< of 8^3 voxels of the level
      T value;
    };
    std::vector<std::pair<int, std::unique_ptr<Leaf>>> leaves; ///< with their levels
    std::vector<Tile> tiles;
    std::array<Sum, 64> sums; ///< of 32^3 voxels
  };

  /// The 128^3 nodes of a child of the root node, x slowest.
  struct RootChild {
    std::vector<EntryKind> kinds = std::vector<EntryKind>(std::size_t(kNodes) * kNodes * kNodes);
    std::vector<Sum> voxels = std::vector<Sum>(kinds.size()); ///< each one's, of uniform ones
    std::vector<std::unique_ptr<Node>> nodes{kinds.size()};   ///< of mixed ones
  };

  LevelBuilder(const LevelRange& levels, LevelMean mean, std::size_t maxMemory)
      : levels_(levels), mean_(mean), maxMemory_(maxMemory) {
    for (int k = levels.first; k <= levels.last; ++k)
      trees_.push_back(std::make_shared<TreeT>(openvdb::zeroVal<T>()));
  }

  /// `entries(n, entry)`: the kind of entry n of the node at `origin`, and its sums. Thread-safe.
  template <class Entries>
  std::unique_ptr<Node> node(const openvdb::Coord& origin, const Entries& entries) const {
    auto result = std::make_unique<Node>();
    std::array<std::vector<std::unique_ptr<Leaf>>, 5> leaves; // by level; x slowest
    for (std::size_t k = 1; k <= 4; ++k)
      leaves[k].resize(std::size_t(1) << (12 - 3 * k));
    std::vector<Sum> sums(4096); // of the entries
    Entry entry;
    for (int n = 0; n < 4096; ++n) {
      const EntryKind kind = entries(n, entry);
      if (kind == EntryKind::Nothing)
        continue;
      const std::array<int, 3> at{n >> 8, n >> 4 & 15, n & 15};
      std::array<Sum, 8> level2;
      std::array<Sum, 1> level3;
      if (kind == EntryKind::Uniform) { // most are
        if (contains(1))
          entry.cubes.fill(entry.voxel.times(8));
        if (contains(2))
          level2.fill(entry.voxel.times(64));
        level3[0] = entry.voxel.times(512);
      } else {
        level2 = sumsOfEight<2>(entry.cubes.data());
        level3 = sumsOfEight<1>(level2.data());
      }
      place<4>(origin, 1, at, entry.cubes, leaves[1]);
      place<2>(origin, 2, at, level2, leaves[2]);
      place<1>(origin, 3, at, level3, leaves[3]);
      sums[static_cast<std::size_t>(n)] = level3[0];
    }
    const auto level4 = sumsOfEight<8>(sums.data());
    place<8>(origin, 4, {0, 0, 0}, level4, leaves[4]);
    result->sums = sumsOfEight<4>(level4.data());
    for (int k = 1; k <= 4; ++k)
      for (auto& leaf : leaves[static_cast<std::size_t>(k)])
        if (leaf)
          keep(k, std::move(leaf), *result);
    return result;
  }

  void add(const openvdb::Coord& origin, RootChild&& child) {
    for (auto& node : child.nodes)
      if (node) {
        for (auto& [k, leaf] : node->leaves)
          tree(k).addLeaf(leaf.release());
        for (const typename Node::Tile& tile : node->tiles)
          tree(tile.level).addTile(1, tile.origin, tile.value, true);
        node->leaves.clear();
        node->tiles.clear();
      }
    for (int k = levels_.first; k <= std::min(levels_.last, 7); ++k)
      addUniform(origin, k, child);
    addCoarse(origin, child);
  }

  /// By level.
  std::vector<typename TreeT::Ptr> finish() {
    for (const auto& one : trees_)
      openvdb::tools::prune(*one);
    return std::move(trees_);
  }

private:
  bool contains(int k) const { return levels_.first <= k && k <= levels_.last; }
  TreeT& tree(int k) { return *trees_[static_cast<std::size_t>(k - levels_.first)]; }

  T mean(const Sum& sum, int k) const {
    const double count = mean_ == LevelMean::OfAll ? std::ldexp(1.0, 3 * k) : sum.active;
    return T(sum.sum / count);
  }

  /// Puts Side^3 voxels of level k into their leaf: those of entry `at` of the node.
  template <int Side, std::size_t Count>
  void place(const openvdb::Coord& origin, int k, const std::array<int, 3>& at,
             const std::array<Sum, Count>& sums, std::vector<std::unique_ptr<Leaf>>& leaves) const {
    if (!contains(k))
      return;
    const std::array<int, 3> first{at[0] * Side, at[1] * Side, at[2] * Side}; // in the node
    const int across = 16 >> k;                                               // leaves
    const std::array<int, 3> which{first[0] / 8, first[1] / 8, first[2] / 8};
    std::unique_ptr<Leaf>& leaf =
        leaves[static_cast<std::size_t>((which[0] * across + which[1]) * across + which[2])];
    for (int x = 0; x < Side; ++x)
      for (int y = 0; y < Side; ++y)
        for (int z = 0; z < Side; ++z) {
          const Sum& sum = sums[static_cast<std::size_t>((x * Side + y) * Side + z)];
          if (sum.active == 0)
            continue;
          if (!leaf)
            leaf = makeLeaf(openvdb::Coord((origin.x() >> k) + which[0] * 8,
                                           (origin.y() >> k) + which[1] * 8,
                                           (origin.z() >> k) + which[2] * 8));
          const int voxel =
              ((first[0] + x) & 7) << 6 | ((first[1] + y) & 7) << 3 | ((first[2] + z) & 7);
          leaf->setValueOn(static_cast<openvdb::Index>(voxel), mean(sum, k));
        }
  }

  std::unique_ptr<Leaf> makeLeaf(const openvdb::Coord& origin) const {
    constexpr std::size_t kBytes = sizeof(Leaf) + Leaf::SIZE * sizeof(T);
    if (bytes_.fetch_add(kBytes) + kBytes > maxMemory_)
      throw Error(Status::Limit, "`lod`",
                  "the coarser grids take more memory than the limit and the machine allow",
                  "begin with a coarser level: the next takes about a quarter");
    return std::make_unique<Leaf>(origin, openvdb::zeroVal<T>(), false);
  }

  void keep(int k, std::unique_ptr<Leaf> leaf, Node& node) const {
    T value{};
    bool active = false;
    if (leaf->isConstant(value, active) && active) {
      node.tiles.push_back({k, leaf->origin(), value});
      bytes_ -= sizeof(Leaf) + Leaf::SIZE * sizeof(T);
      return;
    }
    node.leaves.emplace_back(k, std::move(leaf));
  }

  static std::size_t indexOf(int x, int y, int z) {
    return static_cast<std::size_t>((x * kNodes + y) * kNodes + z);
  }

  void fill(const openvdb::Coord& origin, int k, int side, const Sum& sum) {
    const openvdb::Coord low(origin.x() >> k, origin.y() >> k, origin.z() >> k);
    tree(k).fill(openvdb::CoordBBox(low, low.offsetBy(side - 1)), mean(sum, k), true);
  }

  /// Nodes whose voxels are equal; those that are one 128^3 node of the level together as one tile.
  void addUniform(const openvdb::Coord& origin, int k, const RootChild& child) {
    const int step = std::min(1 << k, kNodes);
    const auto isActive = [&](std::size_t n) {
      return child.kinds[n] == EntryKind::Uniform && child.voxels[n].active > 0;
    };
    for (int x = 0; x < kNodes; x += step)
      for (int y = 0; y < kNodes; y += step)
        for (int z = 0; z < kNodes; z += step) {
          const Sum& first = child.voxels[indexOf(x, y, z)];
          bool same = k <= 5;
          const auto each = [&](const auto& work) {
            for (int i = x; i < x + step; ++i)
              for (int j = y; j < y + step; ++j)
                for (int l = z; l < z + step; ++l)
                  if (!work(openvdb::Coord(i, j, l), indexOf(i, j, l)))
                    return;
          };
          each([&](const openvdb::Coord&, std::size_t n) {
            return same = same && isActive(n) && child.voxels[n].sum == first.sum;
          });
          const double count = std::ldexp(1.0, 3 * k);
          if (same) {
            const openvdb::Coord low = origin.offsetBy(x * 128, y * 128, z * 128);
            tree(k).addTile(2, openvdb::Coord(low.x() >> k, low.y() >> k, low.z() >> k),
                            mean(first.times(count), k), true);
            continue;
          }
          each([&](const openvdb::Coord& at, std::size_t n) {
            if (isActive(n))
              fill(origin.offsetBy(at.x() * 128, at.y() * 128, at.z() * 128), k, 128 >> k,
                   child.voxels[n].times(count));
            return true;
          });
        }
  }

  /// Levels from 5 on, of whose leaves a node has a part.
  void addCoarse(const openvdb::Coord& origin, const RootChild& child) {
    if (levels_.last < 5)
      return;
    std::vector<Sum> sums(child.kinds.size()); // of nodes
    for (std::size_t n = 0; n < sums.size(); ++n) {
      if (child.kinds[n] == EntryKind::Uniform)
        sums[n] = child.voxels[n].times(128.0 * 128 * 128);
      if (child.kinds[n] != EntryKind::Mixed)
        continue;
      const auto i = static_cast<int>(n);
      const openvdb::Coord at =
          origin.offsetBy(i / (kNodes * kNodes) * 128, i / kNodes % kNodes * 128, i % kNodes * 128);
      const auto& level5 = child.nodes[n]->sums;
      const auto level6 = sumsOfEight<2>(level5.data());
      const auto level7 = sumsOfEight<1>(level6.data());
      addVoxels(at, 5, 4, level5.data());
      addVoxels(at, 6, 2, level6.data());
      addVoxels(at, 7, 1, level7.data());
      sums[n] = level7[0];
    }
    const auto level8 = sumsOfEight<16>(sums.data());
    const auto level9 = sumsOfEight<8>(level8.data());
    const auto level10 = sumsOfEight<4>(level9.data());
    const auto level11 = sumsOfEight<2>(level10.data());
    const auto level12 = sumsOfEight<1>(level11.data());
    addVoxels(origin, 8, 16, level8.data());
    addVoxels(origin, 9, 8, level9.data());
    addVoxels(origin, 10, 4, level10.data());
    addVoxels(origin, 11, 2, level11.data());
    addVoxels(origin, 12, 1, level12.data());
  }

  void addVoxels(const openvdb::Coord& origin, int k, int side, const Sum* sums) {
    if (!contains(k))
      return;
    const openvdb::Coord low(origin.x() >> k, origin.y() >> k, origin.z() >> k);
    for (int x = 0; x < side; ++x)
      for (int y = 0; y < side; ++y)
        for (int z = 0; z < side; ++z, ++sums)
          if (sums->active > 0)
            tree(k).setValueOn(low.offsetBy(x, y, z), mean(*sums, k));
  }

  LevelRange levels_;
  LevelMean mean_;
  std::size_t maxMemory_;
  mutable std::atomic<std::size_t> bytes_{0};
  std::vector<typename TreeT::Ptr> trees_;
};

/// The grid of level k of a grid: its name, transform and, for LevelMean::OfActive, all other
/// metadata but its tree's statistics. Throws Error(Usage) for a transform that is not linear.
template <class TreeT>
openvdb::GridBase::Ptr levelGrid(const typename TreeT::Ptr& tree, const openvdb::GridBase& grid,
                                 int k, LevelMean mean) {
  auto level = openvdb::Grid<TreeT>::create(tree);
  finishLevelGrid(*level, grid, k, mean);
  return level;
}

} // namespace tetvdb
