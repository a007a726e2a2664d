// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/volume/NanoGrids.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/NanoVdb.h"

#include <cstring>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <vector>

namespace tetvdb {
namespace {

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
      : root_(*grid.tree().root().data()), background_(root_.mBackground) {}

  typename TreeType::Ptr make() const {
    auto result = std::make_shared<TreeType>(background_);
    std::vector<Child> jobs;
    for (std::uint32_t i = 0; i < root_.mTableSize; ++i) {
      const auto* tile = root_.tile(i);
      const auto at = tile->origin();
      const openvdb::Coord origin(at[0], at[1], at[2]);
      if (tile->isValue()) {
        result->root().addTile(origin, tile->value, tile->state != 0);
        continue;
      }
      auto* upper = new Upper(origin, background_, false);
      result->root().addChild(upper);
      const NanoUpper& from = *root_.getChild(tile)->data();
      for (openvdb::Index n = 0; n < Upper::NUM_VALUES; ++n) {
        if (from.mChildMask.isOn(n))
          jobs.push_back({upper, n, from.getChild(n)->data()});
        else if (from.mValueMask.isOn(n))
          upper->addTile(n, from.getValue(n), true);
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

  std::unique_ptr<Lower> makeLower(const Child& job) const {
    const NanoLower& from = *job.node;
    auto lower =
        std::make_unique<Lower>(job.parent->offsetToGlobalCoord(job.entry), background_, false);
    for (openvdb::Index n = 0; n < Lower::NUM_VALUES; ++n) {
      if (from.mChildMask.isOn(n))
        lower->addLeaf(makeLeaf(*from.getChild(n)->data(), lower->offsetToGlobalCoord(n)));
      else if (from.mValueMask.isOn(n))
        lower->addTile(n, from.getValue(n), true);
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

template <typename TreeType, typename BuildT>
openvdb::GridBase::Ptr make(const unsigned char* bytes) {
  const auto& grid = *reinterpret_cast<const nanovdb::NanoGrid<BuildT>*>(bytes);
  return openvdb::Grid<TreeType>::create(NanoTree<TreeType, BuildT>(grid).make());
}

openvdb::GridBase::Ptr makeOf(nanovdb::GridType type, const unsigned char* bytes) {
  switch (type) {
  case nanovdb::GridType::Float:
    return make<openvdb::FloatTree, float>(bytes);
  case nanovdb::GridType::Int32:
    return make<openvdb::Int32Tree, std::int32_t>(bytes);
  case nanovdb::GridType::Mask:
    return make<openvdb::BoolTree, nanovdb::ValueMask>(bytes);
  case nanovdb::GridType::Boolean:
    return make<openvdb::BoolTree, bool>(bytes);
  default:
    throw Error(Status::Usage, "", "the NanoVDB grid is of a kind that is not built here");
  }
}

} // namespace

openvdb::GridBase::Ptr gridOfNano(const unsigned char* bytes) {
  const auto& header = *reinterpret_cast<const nanovdb::GridData*>(bytes);
  const openvdb::GridBase::Ptr grid = makeOf(header.mGridType, bytes);
  grid->setName(header.mGridName);
  grid->setGridClass(header.mGridClass == nanovdb::GridClass::FogVolume ? openvdb::GRID_FOG_VOLUME
                                                                        : openvdb::GRID_UNKNOWN);
  const auto& size = header.mVoxelSize;
  const double* origin = header.mMap.mVecD;
  grid->setTransform(
      makeTransform({{size[0], size[1], size[2]}, {origin[0], origin[1], origin[2]}}));
  return grid;
}

} // namespace tetvdb
