// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SolidSamples.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <limits>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <type_traits>

namespace tetvdb {
namespace {

// Blocks must not be closer to the end of 32-bit index space.
constexpr std::int32_t kFarthest = std::numeric_limits<std::int32_t>::max() - 4096;

template <class GridT>
class GridSamples : public SolidSamples {
  using Tree = typename GridT::TreeType;
  using Leaf = typename Tree::LeafNodeType;
  using Value = typename GridT::ValueType;
  static constexpr bool kFloat = std::is_floating_point<Value>::value;
  // Not registered with the tree: construction is cheap, and the tree does not change.
  using Accessor = openvdb::tree::ValueAccessor<const Tree, false>;

public:
  explicit GridSamples(const GridT& grid)
      : tree_(grid.constTree()), below_(grid.getGridClass() == openvdb::GRID_LEVEL_SET) {
    if (isInside(tree_.background(), false))
      throw Error(Status::Invalid, "grid '" + grid.getName() + "'",
                  "is inside at infinity: it has no closed surface", "invert its values");
  }

  bool hasHeights() const override { return kFloat; }

  std::vector<Vec3i> blocks(Progress& progress) const override {
    const NodeLists<Tree> nodes(tree_);
    progress.check();
    std::vector<std::vector<Vec3i>> found(nodes.lowers.size());
    tbb::parallel_for(std::size_t(0), nodes.lowers.size(), [&](std::size_t i) {
      addFrom(*nodes.lowers[i], found[i]);
      progress.check();
    });
    found.emplace_back();
    for (const auto* upper : nodes.uppers)
      for (auto tile = upper->cbeginChildOff(); tile; ++tile)
        addTile(tile.getCoord(), 128, tile.getValue(), tile.isValueOn(), found.back());
    for (auto tile = tree_.root().cbeginValueAll(); tile; ++tile)
      addTile(tile.getCoord(), 4096, tile.getValue(), tile.isValueOn(), found.back());
    std::vector<Vec3i> all;
    for (const std::vector<Vec3i>& part : found)
      all.insert(all.end(), part.begin(), part.end());
    tbb::parallel_sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  void load(const Vec3i& block, BlockSamples& samples) const override {
    const Accessor accessor(tree_);
    samples.inside.fill(0);
    for (int neighbour = 0; neighbour < 8; ++neighbour) {
      const Vec3i shift{neighbour & 1, neighbour >> 1 & 1, neighbour >> 2};
      const openvdb::Coord origin(block[0] + kBlock * shift[0], block[1] + kBlock * shift[1],
                                  block[2] + kBlock * shift[2]);
      if (const Leaf* leaf = accessor.probeConstLeaf(origin)) {
        copy(shift, samples, [&](int x, int y, int z) {
          const auto offset = static_cast<openvdb::Index>(x << 6 | y << 3 | z);
          return std::pair<Value, bool>(leaf->getValue(offset), leaf->isValueOn(offset));
        });
        continue;
      }
      Value value;
      const bool active = accessor.probeValue(origin, value);
      copy(shift, samples, [&](int, int, int) { return std::pair<Value, bool>(value, active); });
    }
  }

private:
  bool isInside(const Value& value, bool active) const {
    if constexpr (kFloat)
      return heightOf(value) > 0;
    else
      return active;
  }
  float heightOf(const Value& value) const {
    if constexpr (kFloat)
      return static_cast<float>(below_ ? -value : value - Value(0.5));
    else
      return 0;
  }

  template <class Get>
  void copy(const Vec3i& shift, BlockSamples& samples, const Get& get) const {
    const auto count = [&](std::size_t axis) { return shift[axis] == 0 ? kBlock : 1; };
    for (int x = 0; x < count(0); ++x)
      for (int y = 0; y < count(1); ++y) {
        const auto row =
            static_cast<std::size_t>(kSamples * (kBlock * shift[0] + x) + kBlock * shift[1] + y);
        for (int z = 0; z < count(2); ++z) {
          const auto [value, active] = get(x, y, z);
          const int at = kBlock * shift[2] + z;
          if (isInside(value, active))
            samples.inside[row] = static_cast<std::uint16_t>(samples.inside[row] | 1u << at);
          if constexpr (kFloat)
            samples.height[kSamples * row + static_cast<std::size_t>(at)] = heightOf(value);
        }
      }
  }

  // Whether the eight blocks that a block's samples reach into have different sides, or are leaves.
  bool isMixed(const Accessor& accessor, const openvdb::Coord& block) const {
    int sides = 0;
    for (int neighbour = 0; neighbour < 8; ++neighbour) {
      const openvdb::Coord origin = block.offsetBy(
          kBlock * (neighbour & 1), kBlock * (neighbour >> 1 & 1), kBlock * (neighbour >> 2));
      if (accessor.probeConstLeaf(origin) != nullptr)
        return true;
      Value value;
      const bool active = accessor.probeValue(origin, value);
      sides |= isInside(value, active) ? 1 : 2;
    }
    return sides == 3;
  }

  static void add(const openvdb::Coord& block, std::vector<Vec3i>& blocks) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (block[axis] > kFarthest || block[axis] < -kFarthest)
        throw Error(Status::Limit, "", "the grid reaches the end of 32-bit index space",
                    "move the model nearer to the origin");
    blocks.push_back({block[0], block[1], block[2]});
  }

  // Adds blocks whose samples are partly inside the tile and partly outside: around each of its
  // sides.
  void addTile(const openvdb::Coord& origin, int side, const Value& value, bool active,
               std::vector<Vec3i>& blocks) const {
    if (!isInside(value, active))
      return;
    const Accessor accessor(tree_);
    const int last = side - kBlock;
    for (int x = -kBlock; x <= last; x += kBlock)
      for (int y = -kBlock; y <= last; y += kBlock) {
        const bool whole = x == -kBlock || x == last || y == -kBlock || y == last;
        for (int z = -kBlock; z <= last; z += whole ? kBlock : last + kBlock) {
          const openvdb::Coord block = origin.offsetBy(x, y, z);
          if (isMixed(accessor, block))
            add(block, blocks);
        }
      }
  }

  template <class Lower>
  void addFrom(const Lower& lower, std::vector<Vec3i>& blocks) const {
    const Accessor accessor(tree_);
    for (auto leaf = lower.cbeginChildOn(); leaf; ++leaf) {
      const openvdb::Coord origin = leaf->origin();
      add(origin, blocks);
      // Blocks before it, whose samples reach into it. Leaves are added separately.
      for (int neighbour = 1; neighbour < 8; ++neighbour) {
        const openvdb::Coord block = origin.offsetBy(
            -kBlock * (neighbour & 1), -kBlock * (neighbour >> 1 & 1), -kBlock * (neighbour >> 2));
        if (accessor.probeConstLeaf(block) == nullptr)
          add(block, blocks);
      }
    }
    for (auto tile = lower.cbeginChildOff(); tile; ++tile)
      addTile(tile.getCoord(), kBlock, tile.getValue(), tile.isValueOn(), blocks);
  }

  const Tree& tree_;
  bool below_;
};

template <class GridT>
std::unique_ptr<SolidSamples> samplesOf(const openvdb::GridBase& grid) {
  return grid.isType<GridT>()
             ? std::make_unique<GridSamples<GridT>>(static_cast<const GridT&>(grid))
             : nullptr;
}

std::unique_ptr<SolidSamples> samplesOfAnyType(const openvdb::GridBase& grid) {
  std::unique_ptr<SolidSamples> samples = samplesOf<openvdb::FloatGrid>(grid);
  if (!samples)
    samples = samplesOf<openvdb::BoolGrid>(grid);
  if (!samples)
    samples = samplesOf<openvdb::MaskGrid>(grid);
  return samples;
}

GridTransform transformOf(const openvdb::GridBase& grid) {
  const openvdb::math::Mat4d matrix = grid.transform().isLinear()
                                          ? grid.transform().baseMap()->getAffineMap()->getMat4()
                                          : openvdb::math::Mat4d::zero();
  GridTransform transform;
  bool plain = grid.transform().isLinear();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      plain = plain && (row == column ? matrix(row, column) > 0 : matrix(row, column) == 0);
    transform.voxelSize[static_cast<std::size_t>(row)] = matrix(row, row);
    transform.origin[static_cast<std::size_t>(row)] = matrix(3, row); // row vectors
  }
  if (!plain)
    throw Error(Status::Invalid, "grid '" + grid.getName() + "'",
                "has a transform with a rotation, reflection or shear",
                "resample it along the axes");
  return transform;
}

} // namespace

double SolidSamples::passage(const Vec3i&, std::size_t, bool) const {
  return std::numeric_limits<double>::quiet_NaN();
}

std::unique_ptr<SolidSamples> solidSamples(const Volume& volume, const std::string& name) {
  std::string known;
  for (const openvdb::GridBase::ConstPtr grid : volume.grids().all) {
    known += (known.empty() ? "" : ", ") + grid->getName();
    if (!name.empty() && grid->getName() != name)
      continue;
    std::unique_ptr<SolidSamples> samples = samplesOfAnyType(*grid);
    if (!samples && !name.empty())
      throw Error(Status::Invalid, "grid '" + name + "'",
                  "holds " + grid->valueType() + " values, which define no solid",
                  "choose a mask, a fog volume or a level set");
    if (!samples)
      continue;
    samples->transform = transformOf(*grid);
    return samples;
  }
  throw Error(Status::Invalid, "",
              name.empty() ? "no grid of the volume defines a solid"
                           : "the volume has no grid '" + name + "'",
              known.empty() ? "it holds no grids" : "it holds " + known);
}

} // namespace tetvdb
