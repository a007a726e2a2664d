// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/volume/NanoGrids.h"

#include "nanovdb_kernels/NanoLayout.h"
#include "tetvdb/core/Error.h"

#include <cstring>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <vector>

namespace tetvdb {
namespace {

// One grid's buffer into OpenVDB's nodes.
template <typename TreeType, typename LeafLayout>
class NanoTree {
  using Upper = typename TreeType::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  using Leaf = typename TreeType::LeafNodeType;
  using Value = typename TreeType::ValueType;

public:
  explicit NanoTree(const unsigned char* bytes)
      : bytes_(bytes), root_(bytes + sizeof(nano::GridHeader) + tree().nodeOffset[3]),
        background_(value(rootHeader().values[0])) {}

  typename TreeType::Ptr make() const {
    auto result = std::make_shared<TreeType>(background_);
    std::vector<Child> jobs;
    const auto* tiles = reinterpret_cast<const nano::RootTile*>(root_ + sizeof(nano::RootHeader));
    for (std::uint32_t i = 0; i < rootHeader().tableSize; ++i) {
      const auto along = [&](int shift) {
        return static_cast<openvdb::Int32>(
            static_cast<std::uint32_t>(tiles[i].key >> shift & 0x1FFFFF) << 12);
      };
      const openvdb::Coord origin(along(42), along(21), along(0));
      if (tiles[i].child == 0) {
        result->root().addTile(origin, value(tiles[i].value), tiles[i].state != 0);
        continue;
      }
      auto* upper = new Upper(origin, background_, false);
      result->root().addChild(upper);
      const auto* node = reinterpret_cast<const nano::UpperNode*>(root_ + tiles[i].child);
      for (openvdb::Index n = 0; n < Upper::NUM_VALUES; ++n) {
        if (isOn(node->childMask, n))
          jobs.push_back({upper, n, reinterpret_cast<const unsigned char*>(node) + node->table[n]});
        else if (isOn(node->valueMask, n))
          upper->addTile(n, value(static_cast<std::uint32_t>(node->table[n])), true);
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
    const unsigned char* node;
  };

  const nano::TreeHeader& tree() const {
    return *reinterpret_cast<const nano::TreeHeader*>(bytes_ + sizeof(nano::GridHeader));
  }
  const nano::RootHeader& rootHeader() const {
    return *reinterpret_cast<const nano::RootHeader*>(root_);
  }
  static bool isOn(const std::uint64_t* mask, openvdb::Index n) {
    return (mask[n >> 6] >> (n & 63) & 1) != 0;
  }
  static Value value(std::uint32_t bits) {
    if constexpr (std::is_same_v<Value, bool>) {
      return (bits & 0xFF) != 0;
    } else {
      Value v;
      static_assert(sizeof v == sizeof bits);
      std::memcpy(&v, &bits, sizeof v);
      return v;
    }
  }

  std::unique_ptr<Lower> makeLower(const Child& job) const {
    const auto* node = reinterpret_cast<const nano::LowerNode*>(job.node);
    auto lower =
        std::make_unique<Lower>(job.parent->offsetToGlobalCoord(job.entry), background_, false);
    for (openvdb::Index n = 0; n < Lower::NUM_VALUES; ++n) {
      if (isOn(node->childMask, n))
        lower->addLeaf(makeLeaf(*reinterpret_cast<const LeafLayout*>(job.node + node->table[n]),
                                lower->offsetToGlobalCoord(n)));
      else if (isOn(node->valueMask, n))
        lower->addTile(n, value(static_cast<std::uint32_t>(node->table[n])), true);
    }
    return lower;
  }

  Leaf* makeLeaf(const LeafLayout& from, const openvdb::Coord& origin) const {
    auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), origin, background_, false);
    leaf->allocate();
    for (openvdb::Index w = 0; w < 8; ++w)
      leaf->getValueMask().template getWord<openvdb::Index64>(w) = from.head.mask[w];
    // A bool leaf keeps its values as bits; ours are true where they are active.
    const void* values = from.head.mask;
    if constexpr (!std::is_same_v<Value, bool>)
      values = from.table;
    std::memcpy(leaf->buffer().data(), values, std::is_same_v<Value, bool> ? 64 : 2048);
    return leaf.release();
  }

  const unsigned char* bytes_;
  const unsigned char* root_;
  Value background_;
};

template <typename TreeType, typename LeafLayout>
openvdb::GridBase::Ptr make(const unsigned char* bytes) {
  return openvdb::Grid<TreeType>::create(NanoTree<TreeType, LeafLayout>(bytes).make());
}

} // namespace

openvdb::GridBase::Ptr gridOfNano(const unsigned char* bytes) {
  nano::GridHeader header;
  std::memcpy(&header, bytes, sizeof header);
  openvdb::GridBase::Ptr grid;
  switch (static_cast<nano::Kind>(header.gridType)) {
  case nano::Kind::Float:
    grid = make<openvdb::FloatTree, nano::ValueLeaf>(bytes);
    break;
  case nano::Kind::Int32:
    grid = make<openvdb::Int32Tree, nano::ValueLeaf>(bytes);
    break;
  case nano::Kind::Mask:
    grid = make<openvdb::BoolTree, nano::MaskLeaf>(bytes);
    break;
  case nano::Kind::Bool:
    grid = make<openvdb::BoolTree, nano::BoolLeaf>(bytes);
    break;
  default:
    throw Error(Status::Usage, "", "the NanoVDB grid is of a kind that is not built here");
  }
  grid->setName(header.name);
  grid->setGridClass(header.gridClass == 2 ? openvdb::GRID_FOG_VOLUME : openvdb::GRID_UNKNOWN);
  const double* t = header.mapTranslation;
  grid->setTransform(makeTransform(
      {{header.voxelSize[0], header.voxelSize[1], header.voxelSize[2]}, {t[0], t[1], t[2]}}));
  return grid;
}

} // namespace tetvdb
