// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/volume/LevelsOfDetail.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/volume/GridKinds.h"
#include "tetvdb/volume/GridStatistics.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/LevelBuilder.h"

#include <fmt/format.h>
#include <openvdb/math/Maps.h>
#include <type_traits>

namespace tetvdb {
namespace {

namespace math = openvdb::math;

/// Values as they are added up.
template <class T>
auto asSum(const T& value) {
  if constexpr (std::is_same_v<T, openvdb::Vec3s>)
    return openvdb::Vec3d(value);
  else
    return static_cast<double>(value);
}

/// What is active and false is no voxel of a mask.
template <class T>
bool isVoxel([[maybe_unused]] const T& value) {
  if constexpr (std::is_same_v<T, bool>)
    return value;
  return true;
}

/// Sums of the entries of a 128^3 node of a tree.
template <class Lower, class Builder>
class LowerEntries {
public:
  using Entry = typename Builder::Entry;

  explicit LowerEntries(const Lower& node) : node_(node) {}

  EntryKind operator()(int n, Entry& entry) const {
    const auto index = static_cast<openvdb::Index>(n);
    if (node_.isChildMaskOn(index))
      return add(*node_.getTable()[index].getChild(), entry);
    if (!node_.isValueMaskOn(index))
      return EntryKind::Nothing;
    const auto value = node_.getTable()[index].getValue();
    if (!isVoxel(value))
      return EntryKind::Nothing;
    entry.voxel = {asSum(value), 1};
    return EntryKind::Uniform;
  }

private:
  template <class Leaf>
  static EntryKind add(const Leaf& leaf, Entry& entry) {
    if (leaf.getValueMask().isOff())
      return EntryKind::Nothing;
    entry.cubes.fill({});
    for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
      const auto value = *voxel;
      if (!isVoxel(value))
        continue;
      const openvdb::Index i = voxel.pos();
      const openvdb::Index x = i >> 7, y = i >> 4 & 3, z = i >> 1 & 3;
      entry.cubes[x * 16 + y * 4 + z].add({asSum(value), 1});
    }
    return EntryKind::Mixed;
  }
  const Lower& node_;
};

template <class GridT>
using SumOf = std::conditional_t<std::is_same_v<GridT, openvdb::Vec3SGrid>, openvdb::Vec3d, double>;
template <class GridT>
using LevelTree = std::conditional_t<std::is_same_v<GridT, openvdb::Vec3SGrid>, openvdb::Vec3STree,
                                     openvdb::FloatTree>;

// Arrays of a mesh have the class of a fog too: names tell them from shares of a voxel.
LevelMean meanOf(const openvdb::GridBase& grid) {
  const bool mask = grid.valueType() == "bool" || grid.valueType() == "mask";
  return mask || gridKindOf(grid.getName()) ? LevelMean::OfAll : LevelMean::OfActive;
}

template <class GridT>
openvdb::GridPtrVec levelsOf(const GridT& grid, const LevelRange& levels, std::size_t maxMemory,
                             Progress& progress) {
  using Nodes = NodeLists<typename GridT::TreeType>;
  using Builder = LevelBuilder<LevelTree<GridT>, SumOf<GridT>>;
  using Entries = LowerEntries<typename Nodes::Lower, Builder>;
  const LevelMean mean = meanOf(grid);
  Builder builder(levels, mean, maxMemory);
  for (auto entry = grid.constTree().root().cbeginChildAll(); entry; ++entry) {
    progress.check();
    const openvdb::Coord origin = entry.getCoord();
    typename Builder::RootChild child;
    typename GridT::ValueType value{};
    const typename Nodes::Upper* upper = entry.probeChild(value);
    if (upper == nullptr && !entry.isValueOn())
      continue;
    tbb::parallel_for(std::size_t(0), child.kinds.size(), [&](std::size_t n) {
      const auto index = static_cast<openvdb::Index>(n);
      if (upper != nullptr && upper->isChildMaskOn(index)) {
        progress.check();
        const typename Nodes::Lower& lower = *upper->getTable()[index].getChild();
        child.nodes[n] = builder.node(lower.origin(), Entries(lower));
        child.kinds[n] = EntryKind::Mixed;
        return;
      }
      if (upper != nullptr && !upper->isValueMaskOn(index))
        return;
      const typename GridT::ValueType tile =
          upper != nullptr ? typename GridT::ValueType(upper->getTable()[index].getValue()) : value;
      if (!isVoxel(tile))
        return;
      child.voxels[n] = {asSum(tile), 1};
      child.kinds[n] = EntryKind::Uniform;
    });
    builder.add(origin, std::move(child));
  }
  openvdb::GridPtrVec grids;
  int k = levels.first;
  for (const auto& tree : builder.finish())
    grids.push_back(levelGrid<LevelTree<GridT>>(tree, grid, k++, mean));
  return grids;
}

/// Scale and translation without anything else, if it is no more.
bool isDiagonal(const openvdb::Mat4d& m) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      if (row == column ? !(m(row, column) > 0) : m(row, column) != 0)
        return false;
  return true;
}

// Index i of level k is index 2^k i + (2^k - 1) / 2 of the grid.
math::Transform::Ptr levelTransform(const openvdb::GridBase& grid, int k) {
  if (!grid.transform().isLinear())
    throw Error(Status::Usage, grid.getName(),
                "has a transform that is not linear: coarser voxels have none",
                "choose others with `grid`");
  const openvdb::Mat4d m = grid.transform().baseMap()->getAffineMap()->getConstMat4();
  const double scale = std::ldexp(1.0, k), shift = (scale - 1) / 2;
  if (isDiagonal(m)) {
    GridTransform transform;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<int>(i);
      transform.voxelSize[i] = m(axis, axis) * scale;
      transform.origin[i] = m(3, axis) + m(axis, axis) * shift;
    }
    return makeTransform(transform);
  }
  openvdb::Mat4d finer = openvdb::Mat4d::identity();
  for (int axis = 0; axis < 3; ++axis) {
    finer(axis, axis) = scale;
    finer(3, axis) = shift;
  }
  return std::make_shared<math::Transform>(
      math::MapBase::Ptr(std::make_shared<math::AffineMap>(finer * m)));
}

} // namespace

std::string levelName(const std::string& grid, int level) {
  return fmt::format("{}_level_{}", grid, level);
}

void checkLevels(const LevelRange& levels) {
  if (levels.first < 1 || levels.last > kMaxLevel || levels.first > levels.last)
    throw Error(Status::Usage, "`lod`",
                fmt::format("levels {} to {} were asked for", levels.first, levels.last),
                fmt::format("give levels from 1 to {}, such as 1:6", kMaxLevel));
}

void requireLevels(const std::string& name, std::string_view type, std::string_view gridClass) {
  if (gridClass == "level set")
    throw Error(
        Status::Usage, "`lod`",
        fmt::format("'{}' is a level set, whose narrow band is thinner than coarser voxels", name),
        "leave it out, or make another with larger voxels");
  if (type != "float" && type != "bool" && type != "mask" && type != "vec3s")
    throw Error(Status::Usage, "`lod`",
                fmt::format("'{}' has values of type {}, which have no mean", name, type),
                "leave it out");
}

void finishLevelGrid(openvdb::GridBase& level, const openvdb::GridBase& grid, int k,
                     LevelMean mean) {
  if (mean == LevelMean::OfActive) {
    level.insertMeta(grid);
    removeStatistics(level);
  } else {
    level.setGridClass(openvdb::GRID_FOG_VOLUME);
    level.setSaveFloatAsHalf(grid.saveFloatAsHalf());
  }
  level.setName(levelName(grid.getName(), k));
  level.setTransform(levelTransform(grid, k));
}

void addLevels(Volume& volume, const LevelRange& levels, std::size_t maxMemory,
               Progress& progress) {
  checkLevels(levels);
  openvdb::GridPtrVec& all = volume.grids().all;
  for (const auto& grid : all) {
    requireLevels(grid->getName(), grid->valueType(),
                  openvdb::GridBase::gridClassToString(grid->getGridClass()));
    levelTransform(*grid, 1);
  }
  openvdb::GridPtrVec coarser;
  const std::size_t limit =
      (maxMemory != 0 ? maxMemory : availableBytes()) / std::max<std::size_t>(all.size(), 1);
  for (const auto& grid : all) {
    const auto add = [&](const auto& typed) {
      const openvdb::GridPtrVec own = levelsOf(typed, levels, limit, progress);
      coarser.insert(coarser.end(), own.begin(), own.end());
    };
    using Types = openvdb::TypeList<openvdb::FloatGrid, openvdb::BoolGrid, openvdb::MaskGrid,
                                    openvdb::Vec3SGrid>;
    std::as_const(*grid).apply<Types>(add);
  }
  all.insert(all.end(), coarser.begin(), coarser.end());
}

} // namespace tetvdb
