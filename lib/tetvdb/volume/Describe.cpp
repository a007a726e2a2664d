// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/volume/BitSelect.h"
#include "tetvdb/volume/GridStatistics.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/PackedRange.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <vector>

namespace tetvdb {
namespace {

/// Counts and ranges of some nodes of a tree.
struct Counts {
  std::uint64_t activeVoxels = 0, activeTiles = 0, leaves = 0, bytes = 0;
  openvdb::CoordBBox box; // empty
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  void add(const Counts& other) {
    activeVoxels += other.activeVoxels;
    activeTiles += other.activeTiles;
    leaves += other.leaves;
    bytes += other.bytes;
    box.expand(other.box);
    min = std::min(min, other.min);
    max = std::max(max, other.max);
  }
  void range(double value) { // NaN has no effect
    if (value < min)
      min = value;
    if (value > max)
      max = value;
  }
  template <class T>
  void addTile(const openvdb::Coord& origin, openvdb::Index dim, const T& value) {
    ++activeTiles;
    activeVoxels += std::uint64_t(dim) * dim * dim;
    box.expand(openvdb::CoordBBox::createCube(origin, static_cast<openvdb::Int32>(dim)));
    range(scalarValue(value));
  }
};

/// The range of numbers, in eight lanes, without a branch: inactive lanes are filled with a value
/// that has no effect. NaN has no effect.
template <class T>
class Range {
public:
  explicit Range(T anyActive) : fill_(anyActive) {
    T low = anyActive, high = anyActive;
    if constexpr (std::is_floating_point<T>::value) {
      fill_ = std::numeric_limits<T>::quiet_NaN();
      low = std::numeric_limits<T>::infinity();
      high = -low;
    }
    std::fill_n(low_, 8, low);
    std::fill_n(high_, 8, high);
  }

  /// Those of 64 values whose bit is set.
  void add(const T* values, std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte, values += 8) {
      T lanes[8];
      select(values, word >> (8 * byte) & 0xFF, lanes);
      for (int i = 0; i < 8; ++i)
        low_[i] = lanes[i] < low_[i] ? lanes[i] : low_[i];
      for (int i = 0; i < 8; ++i)
        high_[i] = lanes[i] > high_[i] ? lanes[i] : high_[i];
    }
  }

  void reduceTo(Counts& counts) const {
    for (int i = 0; i < 8; ++i) {
      if (!(low_[i] <= high_[i]))
        continue; // NaN alone
      counts.range(static_cast<double>(low_[i]));
      counts.range(static_cast<double>(high_[i]));
    }
  }

private:
  void select(const T* values, std::uint64_t byte, T* lanes) const {
    if constexpr (sizeof(T) == 4) {
      std::uint32_t bits[8], fill;
      std::memcpy(bits, values, sizeof bits);
      std::memcpy(&fill, &fill_, sizeof fill);
      const auto& mask = kLaneMasks[byte];
      for (std::size_t i = 0; i < 8; ++i)
        bits[i] = (bits[i] & mask[i]) | (fill & ~mask[i]);
      std::memcpy(lanes, bits, sizeof bits);
    } else {
      for (int i = 0; i < 8; ++i)
        lanes[i] = (byte >> i & 1) != 0 ? values[i] : fill_;
    }
  }

  T fill_;
  T low_[8], high_[8];
};

template <class Leaf>
void addLeaf(Counts& counts, const Leaf& leaf, bool packed) {
  using T = typename Leaf::ValueType;
  ++counts.leaves;
  counts.bytes += leaf.memUsage();
  const bool noValues = packed && leaf.transientData() != 0;
  if (noValues)
    counts.bytes += Leaf::SIZE * sizeof(T);
  const auto& mask = leaf.getValueMask();
  const auto active = mask.countOn();
  if (active == 0)
    return;
  counts.activeVoxels += active;
  const auto whole = openvdb::CoordBBox::createCube(leaf.origin(), openvdb::Int32(Leaf::DIM));
  if (!counts.box.isInside(whole)) {
    if (active == Leaf::SIZE)
      counts.box.expand(whole);
    else
      leaf.evalActiveBoundingBox(counts.box);
  }
  if (noValues)
    return;
  if constexpr (std::is_same<T, bool>::value) {
    bool on = false, off = false;
    const auto* values = leaf.buffer().data();
    for (openvdb::Index w = 0; w < 8; ++w) {
      const openvdb::Index64 word = mask.template getWord<openvdb::Index64>(w);
      on |= (word & values[w]) != 0;
      off |= (word & ~values[w]) != 0;
    }
    if (on)
      counts.range(1);
    if (off)
      counts.range(0);
  } else if constexpr (openvdb::VecTraits<T>::IsVec) {
    const T* values = leaf.buffer().data();
    for (auto i = mask.beginOn(); i; ++i)
      counts.range(scalarValue(values[i.pos()]));
  } else {
    const T* values = leaf.buffer().data();
    Range<T> range(values[mask.findFirstOn()]);
    for (openvdb::Index w = 0; w < 8; ++w) {
      const std::uint64_t word = mask.template getWord<openvdb::Index64>(w);
      if (word != 0)
        range.add(values + 64 * w, word);
    }
    range.reduceTo(counts);
  }
}

template <class Lower>
void addLower(Counts& counts, const Lower& node, bool packed) {
  counts.bytes += sizeof(Lower);
  for (auto child = node.cbeginChildOn(); child; ++child)
    addLeaf(counts, *child, packed);
  for (auto tile = node.cbeginValueOn(); tile; ++tile)
    counts.addTile(tile.getCoord(), Lower::ChildNodeType::DIM, *tile);
}

template <class TreeT>
Counts count(const TreeT& tree, bool packed) {
  const NodeLists<TreeT> nodes(tree);
  Counts total = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, nodes.lowers.size()), Counts{},
      [&](const auto& range, Counts counts) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
          addLower(counts, *nodes.lowers[i], packed);
        return counts;
      },
      [](Counts a, const Counts& b) {
        a.add(b);
        return a;
      });
  for (const auto* node : nodes.uppers) {
    total.bytes += sizeof(*node);
    for (auto tile = node->cbeginValueOn(); tile; ++tile)
      total.addTile(tile.getCoord(), NodeLists<TreeT>::Lower::DIM, *tile);
  }
  total.bytes += sizeof(tree);
  for (auto tile = tree.root().cbeginValueOn(); tile; ++tile)
    total.addTile(tile.getCoord(), NodeLists<TreeT>::Upper::DIM, *tile);
  return total;
}

// Voxels of negative value, active or not: those inside a level set.
template <class TreeT>
double countNegative(const TreeT& tree) {
  using Lists = NodeLists<TreeT>;
  const auto negative = [](const auto& value) { return value < 0; };
  const Lists nodes(tree);
  const auto tiles = [&](const auto& node, double dim) {
    std::uint64_t found = 0;
    for (auto tile = node.cbeginValueAll(); tile; ++tile)
      found += negative(*tile) ? 1 : 0;
    return static_cast<double>(found) * dim * dim * dim;
  };
  // Whole numbers: the same in any order.
  double sum = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, nodes.lowers.size()), 0.0,
      [&](const auto& range, double part) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          for (auto leaf = nodes.lowers[i]->cbeginChildOn(); leaf; ++leaf) {
            const auto* values = leaf->buffer().data();
            part += static_cast<double>(std::count_if(values, values + leaf->SIZE, negative));
          }
          part += tiles(*nodes.lowers[i], static_cast<double>(TreeT::LeafNodeType::DIM));
        }
        return part;
      },
      std::plus<>());
  for (const auto* node : nodes.uppers)
    sum += tiles(*node, Lists::Lower::DIM);
  for (auto tile = tree.root().cbeginValueAll(); tile; ++tile)
    sum += negative(*tile) ? std::pow(static_cast<double>(Lists::Upper::DIM), 3) : 0;
  return sum;
}

// The sum of all active values, in an order that does not depend on threads.
double sumOfActive(const openvdb::FloatTree& tree) {
  using Lists = NodeLists<openvdb::FloatTree>;
  const Lists nodes(tree);
  std::vector<double> sums(nodes.lowers.size());
  tbb::parallel_for(std::size_t(0), sums.size(), [&](std::size_t i) {
    for (auto leaf = nodes.lowers[i]->cbeginChildOn(); leaf; ++leaf)
      for (auto value = leaf->cbeginValueOn(); value; ++value)
        sums[i] += static_cast<double>(*value);
    for (auto tile = nodes.lowers[i]->cbeginValueOn(); tile; ++tile)
      sums[i] += static_cast<double>(*tile) * std::pow(8.0, 3);
  });
  double sum = 0;
  for (const double part : sums)
    sum += part;
  for (const auto* node : nodes.uppers)
    for (auto tile = node->cbeginValueOn(); tile; ++tile)
      sum += static_cast<double>(*tile) * std::pow(static_cast<double>(Lists::Lower::DIM), 3);
  for (auto tile = tree.root().cbeginValueOn(); tile; ++tile)
    sum += static_cast<double>(*tile) * std::pow(static_cast<double>(Lists::Upper::DIM), 3);
  return sum;
}

// The volume inside, in voxels.
double voxelsInside(const openvdb::GridBase& grid, std::uint64_t active) {
  if (grid.isType<openvdb::FloatGrid>()) {
    const auto& tree = static_cast<const openvdb::FloatGrid&>(grid).constTree();
    if (grid.getGridClass() == openvdb::GRID_LEVEL_SET)
      return countNegative(tree);
    if (holdsShares(grid.getName()))
      return sumOfActive(tree);
  }
  return static_cast<double>(active);
}

Vec3i toArray(const openvdb::Coord& c) {
  return {c.x(), c.y(), c.z()};
}

GridInfo describeGrid(const openvdb::GridBase& grid, const PackedRange* packed) {
  GridInfo info;
  info.name = grid.getName();
  info.type = grid.valueType();
  info.gridClass = openvdb::GridBase::gridClassToString(grid.getGridClass());
  for (auto entry = grid.beginMeta(); entry != grid.endMeta(); ++entry)
    info.metadata[entry->first] = entry->second->str();

  const auto& transform = grid.transform();
  const openvdb::Vec3d size = transform.voxelSize();
  const openvdb::Vec3d origin = transform.indexToWorld(openvdb::Vec3d(0.0));
  info.transform.voxelSize = {size.x(), size.y(), size.z()};
  info.transform.origin = {origin.x(), origin.y(), origin.z()};
  info.linear = transform.isLinear();
  if (info.linear) {
    const openvdb::Mat4d matrix = transform.baseMap()->getAffineMap()->getConstMat4();
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        info.linear =
            info.linear && (row == column ? matrix(row, column) > 0 : matrix(row, column) == 0);
  }

  Counts counts;
  const bool known = withKnownGrid(
      grid, [&](const auto& typed) { counts = count(typed.constTree(), packed != nullptr); });
  if (packed != nullptr && packed->min <= packed->max) {
    counts.range(packed->min);
    counts.range(packed->max);
  }
  if (!known)
    throw Error(Status::Usage, grid.getName(),
                "grids of type " + grid.type() + " are not supported");
  info.activeVoxels = counts.activeVoxels;
  info.activeTiles = counts.activeTiles;
  info.leaves = counts.leaves;
  info.bytes = counts.bytes;
  const auto inside = packed != nullptr ? static_cast<double>(counts.activeVoxels)
                                        : voxelsInside(grid, counts.activeVoxels);
  info.volume = inside * std::abs(transform.voxelVolume()); // below 0 where an axis is mirrored
  if (!counts.box.empty()) {
    info.boxMin = toArray(counts.box.min());
    info.boxMax = toArray(counts.box.max());
  }
  if (counts.min <= counts.max) {
    info.minValue = counts.min + 0.0; // -0 becomes 0, whichever of the two was met first
    info.maxValue = counts.max + 0.0;
  }
  return info;
}

} // namespace

bool holdsShares(const std::string& name) {
  if (name == "coverage")
    return true;
  for (const char* base : {"coverage_level_", "density_level_", "mask_level_"})
    if (name.rfind(base, 0) == 0)
      return true;
  return false;
}

std::vector<GridInfo> describe(const Volume& volume) {
  std::vector<GridInfo> result;
  for (const auto& grid : volume.grids().all)
    result.push_back(describeGrid(*grid, nullptr));
  return result;
}

GridInfo describePacked(const openvdb::GridBase& grid, const PackedRange& range) {
  return describeGrid(grid, &range);
}

} // namespace tetvdb
