// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/volume/LevelsOfDetail.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/volume/GridKinds.h"
#include "tetvdb/volume/GridLevels.h"
#include "tetvdb/volume/GridStatistics.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/LevelBuilder.h"

#include <fmt/format.h>
#include <openvdb/math/Maps.h>
#include <optional>
#include <tbb/parallel_for.h>
#include <type_traits>
#include <utility>

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
class TypedLevels : public GridLevels {
  using Nodes = NodeLists<typename GridT::TreeType>;
  using Builder = LevelBuilder<LevelTree<GridT>, SumOf<GridT>>;
  using Entries = LowerEntries<typename Nodes::Lower, Builder>;
  using Upper = typename Nodes::Upper;
  using T = typename GridT::ValueType;

public:
  TypedLevels(openvdb::GridBase::ConstPtr grid, const LevelRange& levels, std::size_t maxMemory)
      : grid_(std::move(grid)), levels_(levels), builder_(levels, meanOf(*grid_), maxMemory) {}

  void add(const openvdb::GridBase& part, Progress& progress) override {
    const auto& root = static_cast<const GridT&>(part).constTree().root();
    for (auto entry = root.cbeginChildAll(); entry; ++entry) {
      progress.check();
      T value{};
      const Upper* upper = entry.probeChild(value);
      if (upper == nullptr && !entry.isValueOn())
        continue;
      if (origin_ != entry.getCoord()) {
        endCube();
        origin_ = entry.getCoord();
      }
      tbb::parallel_for(std::size_t(0), child_.kinds.size(), [&](std::size_t n) {
        const auto index = static_cast<openvdb::Index>(n);
        if (upper != nullptr && upper->isChildMaskOn(index)) {
          progress.check();
          const typename Nodes::Lower& lower = *upper->getTable()[index].getChild();
          child_.nodes[n] = builder_.node(lower.origin(), Entries(lower));
          child_.kinds[n] = EntryKind::Mixed;
          return;
        }
        if (upper != nullptr && !upper->isValueMaskOn(index))
          return;
        const T tile = upper != nullptr ? T(upper->getTable()[index].getValue()) : value;
        if (!isVoxel(tile))
          return;
        child_.voxels[n] = {asSum(tile), 1};
        child_.kinds[n] = EntryKind::Uniform;
      });
    }
  }

  openvdb::GridPtrVec finish() override {
    endCube();
    openvdb::GridPtrVec grids;
    int k = levels_.first;
    for (const auto& tree : builder_.finish())
      grids.push_back(levelGrid<LevelTree<GridT>>(tree, *grid_, k++, meanOf(*grid_)));
    return grids;
  }

private:
  void endCube() {
    if (origin_)
      builder_.add(*origin_, std::exchange(child_, {}));
    origin_.reset();
  }

  openvdb::GridBase::ConstPtr grid_;
  LevelRange levels_;
  Builder builder_;
  std::optional<openvdb::Coord> origin_; ///< of the cube under way
  typename Builder::RootChild child_;
};

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

std::unique_ptr<GridLevels> makeGridLevels(const openvdb::GridBase::ConstPtr& grid,
                                           const LevelRange& levels, std::size_t maxMemory) {
  checkLevels(levels);
  requireLevels(grid->getName(), grid->valueType(),
                openvdb::GridBase::gridClassToString(grid->getGridClass()));
  levelTransform(*grid, 1);
  std::unique_ptr<GridLevels> made;
  using Types = openvdb::TypeList<openvdb::FloatGrid, openvdb::BoolGrid, openvdb::MaskGrid,
                                  openvdb::Vec3SGrid>;
  grid->apply<Types>([&](const auto& typed) {
    made = std::make_unique<TypedLevels<std::decay_t<decltype(typed)>>>(grid, levels, maxMemory);
  });
  return made;
}

void addLevels(Volume& volume, const LevelRange& levels, std::size_t maxMemory,
               Progress& progress) {
  openvdb::GridPtrVec& all = volume.grids().all;
  const std::size_t limit =
      (maxMemory != 0 ? maxMemory : availableBytes()) / std::max<std::size_t>(all.size(), 1);
  checkLevels(levels);
  std::vector<std::unique_ptr<GridLevels>> made; // after all are found to have levels
  for (const auto& grid : all)
    made.push_back(makeGridLevels(grid, levels, limit));
  openvdb::GridPtrVec coarser;
  for (std::size_t g = 0; g < made.size(); ++g) {
    made[g]->add(*all[g], progress);
    const openvdb::GridPtrVec own = made[g]->finish();
    coarser.insert(coarser.end(), own.begin(), own.end());
    made[g].reset();
  }
  all.insert(all.end(), coarser.begin(), coarser.end());
}

} // namespace tetvdb
