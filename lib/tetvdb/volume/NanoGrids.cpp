// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/volume/NanoGrids.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/NanoVdb.h"
#include "tetvdb/volume/GridStatistics.h"
#include "tetvdb/volume/NodeBytes.h"
#include "tetvdb/volume/PackedRange.h"

#include <cstdlib>
#include <cstring>
#include <iterator>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <type_traits>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

// OpenVDB's value of NanoVDB's.
template <typename T>
T openValue(const T& value) {
  return value;
}
openvdb::Vec3s openValue(const nanovdb::Vec3f& v) {
  return {v[0], v[1], v[2]};
}

// One grid's buffer into OpenVDB's nodes.
template <typename TreeType, typename BuildT>
class NanoTree {
  using Upper = typename TreeType::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  using Leaf = typename TreeType::LeafNodeType;
  using Value = typename TreeType::ValueType;
  using NanoUpper = typename nanovdb::NanoUpper<BuildT>::DataType;
  using NanoLower = typename nanovdb::NanoLower<BuildT>::DataType;
  using NanoLeaf = typename nanovdb::NanoLeaf<BuildT>::DataType;

public:
  explicit NanoTree(const nanovdb::NanoGrid<BuildT>& grid)
      : root_(*grid.tree().root().data()), background_(openValue(root_.mBackground)) {}

  typename TreeType::Ptr make() const {
    auto result = std::make_shared<TreeType>(background_);
    std::vector<Child> jobs;
    for (std::uint32_t i = 0; i < root_.mTableSize; ++i) {
      const auto* tile = root_.tile(i);
      const auto at = tile->origin();
      const openvdb::Coord origin(at[0], at[1], at[2]);
      if (tile->isValue()) {
        result->root().addTile(origin, openValue(tile->value), tile->state != 0);
        continue;
      }
      auto* upper = new Upper(origin, background_, false);
      result->root().addChild(upper);
      const NanoUpper& from = *root_.getChild(tile)->data();
      for (openvdb::Index n = 0; n < Upper::NUM_VALUES; ++n) {
        if (from.mChildMask.isOn(n))
          jobs.push_back({upper, n, from.getChild(n)->data()});
        else
          addTile(from, n, *upper);
      }
    }
    std::vector<std::unique_ptr<Lower>> lowers(jobs.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, jobs.size(), 1), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i)
        lowers[i] = makeLower(jobs[i]);
    });
    for (std::size_t i = 0; i < jobs.size(); ++i)
      jobs[i].parent->addChild(lowers[i].release());
    return result;
  }

private:
  struct Child {
    Upper* parent;
    openvdb::Index entry;
    const NanoLower* node;
  };

  // Unless the node has it already. A level set has inactive tiles of two values.
  template <typename From, typename To>
  void addTile(const From& from, openvdb::Index n, To& to) const {
    const bool active = from.mValueMask.isOn(n);
    const Value value = openValue(from.getValue(n));
    if (active || value != background_)
      to.addTile(n, value, active);
  }

  std::unique_ptr<Lower> makeLower(const Child& job) const {
    const NanoLower& from = *job.node;
    auto lower =
        std::make_unique<Lower>(job.parent->offsetToGlobalCoord(job.entry), background_, false);
    for (openvdb::Index n = 0; n < Lower::NUM_VALUES; ++n) {
      if (from.mChildMask.isOn(n))
        lower->addLeaf(makeLeaf(*from.getChild(n)->data(), lower->offsetToGlobalCoord(n)));
      else
        addTile(from, n, *lower);
    }
    return lower;
  }

  Leaf* makeLeaf(const NanoLeaf& from, const openvdb::Coord& origin) const {
    auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), origin, background_, false);
    leaf->allocate();
    std::memcpy(&leaf->getValueMask().template getWord<openvdb::Index64>(0), &from.mValueMask,
                sizeof from.mValueMask);
    // A bool leaf keeps its values as bits; ours are true where they are active.
    if constexpr (std::is_same_v<Value, bool>)
      std::memcpy(leaf->buffer().data(), &from.mValueMask, sizeof from.mValueMask);
    else
      std::memcpy(leaf->buffer().data(), from.mValues, sizeof from.mValues);
    return leaf.release();
  }

  const typename nanovdb::NanoRoot<BuildT>::DataType& root_;
  Value background_;
};

// Calls visit(child) for a node's children, in order; visit(value) for its active tiles.
template <typename Node, typename Visit>
void forChildren(const Node& node, const Visit& visit) {
  for (std::uint32_t n = 0; n < std::size(node.mTable); ++n)
    if (node.mChildMask.isOn(n))
      visit(*node.getChild(n)->data());
}
template <typename Node, typename Visit>
void forTiles(const Node& node, const Visit& visit) {
  for (std::uint32_t n = 0; n < std::size(node.mTable); ++n)
    if (!node.mChildMask.isOn(n) && node.mValueMask.isOn(n))
      visit(static_cast<double>(node.getValue(n)));
}

// The sum of all active values, in describe()'s order.
double sumOfActive(const nanovdb::NanoGrid<float>& grid) {
  const auto& root = *grid.tree().root().data();
  std::vector<const nanovdb::NanoUpper<float>::DataType*> uppers;
  std::vector<const nanovdb::NanoLower<float>::DataType*> lowers;
  for (std::uint32_t i = 0; i < root.mTableSize; ++i) {
    if (root.tile(i)->isValue())
      continue;
    uppers.push_back(root.getChild(root.tile(i))->data());
    forChildren(*uppers.back(), [&](const auto& lower) { lowers.push_back(&lower); });
  }
  std::vector<double> sums(lowers.size());
  tbb::parallel_for(std::size_t(0), sums.size(), [&](std::size_t i) {
    forChildren(*lowers[i], [&](const auto& leaf) {
      for (std::uint32_t v = 0; v < std::size(leaf.mValues); ++v)
        if (leaf.mValueMask.isOn(v))
          sums[i] += static_cast<double>(leaf.mValues[v]);
    });
    forTiles(*lowers[i], [&](double value) { sums[i] += value * 0x1p9; });
  });
  double sum = 0;
  for (const double part : sums)
    sum += part;
  for (const auto* upper : uppers)
    forTiles(*upper, [&](double value) { sum += value * 0x1p21; });
  for (std::uint32_t i = 0; i < root.mTableSize; ++i)
    if (const auto& tile = *root.tile(i); tile.isValue() && tile.state != 0)
      sum += static_cast<double>(tile.value) * 0x1p36;
  return sum;
}

// Calls f(grid, tree) with the typed grid at `bytes` and a null pointer to OpenVDB's type of its
// tree.
template <typename F>
auto withNanoGrid(const unsigned char* bytes, const F& f) {
  const auto typed = [&](auto build, auto* tree) {
    return f(*reinterpret_cast<const nanovdb::NanoGrid<decltype(build)>*>(bytes), tree);
  };
  switch (reinterpret_cast<const nanovdb::GridData*>(bytes)->mGridType) {
  case nanovdb::GridType::Float:
    return typed(float(), static_cast<openvdb::FloatTree*>(nullptr));
  case nanovdb::GridType::Int32:
    return typed(std::int32_t(), static_cast<openvdb::Int32Tree*>(nullptr));
  case nanovdb::GridType::Vec3f:
    return typed(nanovdb::Vec3f(), static_cast<openvdb::Vec3STree*>(nullptr));
  case nanovdb::GridType::Mask:
    return typed(nanovdb::ValueMask(), static_cast<openvdb::BoolTree*>(nullptr));
  case nanovdb::GridType::Boolean:
    return typed(bool(), static_cast<openvdb::BoolTree*>(nullptr));
  default:
    throw Error(Status::Usage, "", "the NanoVDB grid is of a kind that is not built here");
  }
}

// OpenVDB's grid of a tree, with what the head at `bytes` says of it.
openvdb::GridBase::Ptr named(const openvdb::GridBase::Ptr& grid, const unsigned char* bytes) {
  const auto& header = *reinterpret_cast<const nanovdb::GridData*>(bytes);
  grid->setName(header.mGridName);
  grid->setGridClass(header.mGridClass == nanovdb::GridClass::FogVolume  ? openvdb::GRID_FOG_VOLUME
                     : header.mGridClass == nanovdb::GridClass::LevelSet ? openvdb::GRID_LEVEL_SET
                                                                         : openvdb::GRID_UNKNOWN);
  const auto& size = header.mVoxelSize;
  const double* origin = header.mMap.mVecD;
  grid->setTransform(
      makeTransform({{size[0], size[1], size[2]}, {origin[0], origin[1], origin[2]}}));
  return grid;
}

} // namespace

openvdb::GridBase::Ptr gridOfNano(const unsigned char* bytes) {
  return withNanoGrid(bytes, [&](const auto& nano, auto* tree) {
    using TreeType = std::remove_pointer_t<decltype(tree)>;
    using BuildT = typename std::decay_t<decltype(nano)>::BuildType;
    return named(openvdb::Grid<TreeType>::create(NanoTree<TreeType, BuildT>(nano).make()), bytes);
  });
}

std::pair<unsigned char*, NanoBytes> newNanoBytes(std::size_t size) {
  const std::shared_ptr<unsigned char> memory(
      static_cast<unsigned char*>(std::aligned_alloc(64, (size + 63) / 64 * 64)), std::free);
  if (memory == nullptr)
    throw Error(Status::Limit, "", "the grid does not fit in memory");
  return {memory.get(), {memory, size, 0}};
}

NanoBytes copyOf(const NanoBytes& grid) {
  auto [memory, copy] = newNanoBytes(grid.size);
  std::memcpy(memory, grid.data.get(), grid.size);
  copy.insideVoxels = grid.insideVoxels;
  return copy;
}

GridInfo describeNano(const unsigned char* bytes, std::uint64_t insideVoxels) {
  return withNanoGrid(bytes, [&](const auto& nano, auto* tree) {
    using TreeType = std::remove_pointer_t<decltype(tree)>;
    using Value = typename TreeType::ValueType;
    const auto& root = *nano.tree().root().data();
    Volume empty;
    empty.grids().all = {
        named(openvdb::Grid<TreeType>::create(Value(openValue(root.mBackground))), bytes)};
    GridInfo info = describe(empty).front();
    const auto& counts = *nano.tree().data();
    info.leaves = counts.mNodeCount[0];
    info.bytes = describedNodeBytes<TreeType>().of(counts.mNodeCount[2], counts.mNodeCount[1],
                                                   counts.mNodeCount[0]);
    info.activeVoxels = counts.mVoxelCount;
    for (const auto tiles : counts.mTileCount)
      info.activeTiles += tiles;
    if (info.activeVoxels == 0)
      return info;
    const openvdb::GridBase& head = *empty.grids().all.front();
    const bool levelSet = head.getGridClass() == openvdb::GRID_LEVEL_SET;
    auto inside = static_cast<double>(levelSet ? insideVoxels : info.activeVoxels);
    if constexpr (std::is_same_v<Value, float>)
      if (holdsShares(head.getName()))
        inside = sumOfActive(nano);
    info.volume = inside * head.transform().voxelVolume();
    const auto box = root.mBBox;
    info.boxMin = {box.min()[0], box.min()[1], box.min()[2]};
    info.boxMax = {box.max()[0], box.max()[1], box.max()[2]};
    info.minValue = info.maxValue = 1;
    if constexpr (!std::is_same_v<Value, bool>) {
      info.minValue = scalarValue(openValue(root.mMinimum)) + 0.0; // no -0, as describe()
      info.maxValue = scalarValue(openValue(root.mMaximum)) + 0.0;
    }
    return info;
  });
}

} // namespace tetvdb
