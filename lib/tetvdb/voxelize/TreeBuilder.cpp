// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/TreeBuilder.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tuple>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::int32_t kChildrenPerAxis = kRootChildSize / kNodeSize; // of an upper node

// Which leaves of a slab are empty, full or mixed, from its rows.
class LeafRows {
public:
  // Leaves with y / 8 = leafY.
  LeafRows(const SlabBits& bits, int leafY) : bits_(bits), leafY_(leafY) {
    for (int x = 0; x < kLeafSize; ++x)
      for (int y = 0; y < kLeafSize; ++y) {
        const std::uint64_t* row = bits.rows[x * kNodeSize + leafY * kLeafSize + y];
        any_[0] |= row[0];
        any_[1] |= row[1];
        all_[0] &= row[0];
        all_[1] &= row[1];
      }
  }
  bool empty() const { return (any_[0] | any_[1]) == 0; }
  bool empty(int leafZ) const { return byte(any_, leafZ) == 0; }
  bool full(int leafZ) const { return byte(all_, leafZ) == 0xFF; }

  // Mask word of x slab `x` of the leaf: bit 8 y + z.
  std::uint64_t word(int leafZ, int x) const {
    std::uint64_t w = 0;
    const int shift = (leafZ & 7) * 8;
    for (int y = 0; y < kLeafSize; ++y)
      w |= (bits_.rows[x * kNodeSize + leafY_ * kLeafSize + y][leafZ >> 3] >> shift & 0xFF)
           << (8 * y);
    return w;
  }

private:
  static std::uint64_t byte(const std::uint64_t* words, int leafZ) {
    return words[leafZ >> 3] >> ((leafZ & 7) * 8) & 0xFF;
  }
  const SlabBits& bits_;
  int leafY_;
  std::uint64_t any_[2] = {0, 0};
  std::uint64_t all_[2] = {~std::uint64_t(0), ~std::uint64_t(0)};
};

// The value of every active voxel is the same.
template <typename Value>
struct ConstantFill {
  Value inside, background;
  static constexpr bool kConstant = true;
  Value operator()(std::uint32_t) const { return inside; }
};

// The value is the number of the input cell that owns the voxel.
struct CellFill {
  const std::uint32_t* cellOfTet; // null: the tet's own number
  std::int32_t background = -1;
  static constexpr bool kConstant = false;
  std::int32_t operator()(std::uint32_t tet) const {
    return static_cast<std::int32_t>(cellOfTet != nullptr ? cellOfTet[tet] : tet);
  }
};

// The value is the region number of that cell.
struct RegionFill {
  CellFill cell;
  const std::int32_t* regions; // null: 0 throughout
  std::int32_t background = -1;
  static constexpr bool kConstant = false;
  std::int32_t operator()(std::uint32_t tet) const {
    return regions != nullptr ? regions[cell(tet)] : 0;
  }
};

struct Run {
  std::int32_t x, y, zBegin, zEnd;
};

} // namespace

std::size_t leafBytes(GridKind kind) {
  constexpr std::size_t allocation = 16;
  return kind == GridKind::Mask ? 144 + allocation : 96 + 2048 + 2 * allocation;
}

class TreeBuilder::GridBuilder {
public:
  virtual ~GridBuilder() = default;
  virtual void* begin(const NodeIndex& node) = 0;
  virtual void slab(void* node, int index, const SlabBits& bits, const std::uint32_t* owners) = 0;
  virtual void end(void* node, const NodeIndex& index) = 0;
  virtual void drop(void* node) = 0;
  virtual void fullRun(const Run& run) = 0;
  virtual void fullNode(const NodeIndex& node, std::uint32_t owner) = 0;
  virtual openvdb::GridBase::Ptr finish(const GridTransform& transform) = 0;
};

template <typename TreeType, typename Fill>
class TreeBuilder::TypedBuilder : public TreeBuilder::GridBuilder {
  using Leaf = typename TreeType::LeafNodeType;
  using Upper = typename TreeType::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  using Value = typename TreeType::ValueType;

public:
  TypedBuilder(std::string name, openvdb::GridClass gridClass, Fill fill)
      : name_(std::move(name)), class_(gridClass), fill_(std::move(fill)) {}

  ~TypedBuilder() override {
    for (Part& part : collect())
      delete part.node;
  }

  void* begin(const NodeIndex& node) override {
    return new Lower(openvdb::Coord(node[0] * kNodeSize, node[1] * kNodeSize, node[2] * kNodeSize),
                     fill_.background, false);
  }

  void slab(void* node, int index, const SlabBits& bits, const std::uint32_t* owners) override {
    auto* lower = static_cast<Lower*>(node);
    const openvdb::Coord corner = lower->origin().offsetBy(index * kLeafSize, 0, 0);
    for (int leafY = 0; leafY < kSlabsPerNode; ++leafY) {
      const LeafRows rows(bits, leafY);
      if (rows.empty())
        continue;
      for (int leafZ = 0; leafZ < kSlabsPerNode; ++leafZ) {
        if (rows.empty(leafZ))
          continue;
        const auto offset = static_cast<openvdb::Index>((index << 8) | (leafY << 4) | leafZ);
        const std::uint32_t* first =
            owners == nullptr ? nullptr
                              : owners + (leafY * kLeafSize * kNodeSize + leafZ * kLeafSize);
        if (rows.full(leafZ) && oneValue(first)) {
          lower->addTile(offset, valueAt(first), true);
          continue;
        }
        lower->addLeaf(
            makeLeaf(corner.offsetBy(0, leafY * kLeafSize, leafZ * kLeafSize), rows, leafZ, first));
      }
    }
  }

  void end(void* node, const NodeIndex& index) override {
    std::unique_ptr<Lower> lower(static_cast<Lower*>(node));
    // Only the first tile can decide: a node is one tile if all its values are.
    if (lower->getChildMask().isOff()) {
      if (lower->getValueMask().isOff())
        return;
      Value value{};
      bool state = false;
      if (lower->isConstant(value, state) && state) {
        parts_.local().push_back({index, nullptr, value});
        return;
      }
    }
    parts_.local().push_back({index, lower.release(), Value{}});
  }

  void drop(void* node) override { delete static_cast<Lower*>(node); }

  void fullRun(const Run& run) override { runs_.local().push_back(run); }

  void fullNode(const NodeIndex& node, std::uint32_t owner) override {
    parts_.local().push_back({node, nullptr, fill_(owner)});
  }

  openvdb::GridBase::Ptr finish(const GridTransform& transform) override {
    // Upper nodes by origin, each with the parts and runs inside it.
    struct UpperParts {
      std::vector<Part> parts;
      std::vector<Run> runs;
    };
    std::map<std::tuple<int, int, int>, UpperParts> uppers;
    const auto upperOf = [](std::int32_t node) { return node >> 5; };
    for (const Part& part : collect())
      uppers[{upperOf(part.index[0]), upperOf(part.index[1]), upperOf(part.index[2])}]
          .parts.push_back(part);
    parts_.clear();
    for (const auto& local : runs_)
      for (const Run& run : local)
        for (std::int32_t z = run.zBegin; z < run.zEnd;) {
          const std::int32_t end = std::min((upperOf(z) + 1) * kChildrenPerAxis, run.zEnd);
          uppers[{upperOf(run.x), upperOf(run.y), upperOf(z)}].runs.push_back(
              {run.x, run.y, z, end});
          z = end;
        }
    runs_.clear();

    std::vector<std::pair<openvdb::Coord, const UpperParts*>> list;
    for (const auto& [key, parts] : uppers)
      list.emplace_back(openvdb::Coord(std::get<0>(key) * kRootChildSize,
                                       std::get<1>(key) * kRootChildSize,
                                       std::get<2>(key) * kRootChildSize),
                        &parts);
    std::vector<std::unique_ptr<Upper>> nodes(list.size());
    std::vector<std::pair<bool, Value>> tiles(list.size()); // the upper node is one tile
    tbb::parallel_for(std::size_t(0), list.size(), [&](std::size_t i) {
      auto upper = std::make_unique<Upper>(list[i].first, fill_.background, false);
      for (const Run& run : list[i].second->runs)
        for (std::int32_t z = run.zBegin; z < run.zEnd; ++z)
          upper->addTile(offsetInUpper({run.x, run.y, z}), fill_(0), true);
      for (const Part& part : list[i].second->parts) {
        if (part.node != nullptr)
          upper->addChild(part.node);
        else
          upper->addTile(offsetInUpper(part.index), part.value, true);
      }
      Value value{};
      bool state = false;
      if (upper->getChildMask().isOff() && upper->isConstant(value, state) && state)
        tiles[i] = {true, value};
      else
        nodes[i] = std::move(upper);
    });

    auto tree = std::make_shared<TreeType>(fill_.background);
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (nodes[i])
        tree->root().addChild(nodes[i].release());
      else
        tree->root().addTile(list[i].first, tiles[i].second, true);
    }
    auto grid = openvdb::Grid<TreeType>::create(tree);
    grid->setName(name_);
    grid->setGridClass(class_);
    grid->setTransform(makeTransform(transform));
    return grid;
  }

private:
  // A lower node, or a tile in its place where node is null.
  struct Part {
    NodeIndex index;
    Lower* node;
    Value value;
  };

  std::vector<Part> collect() const {
    std::vector<Part> all;
    for (const auto& local : parts_)
      all.insert(all.end(), local.begin(), local.end());
    return all;
  }

  static openvdb::Index offsetInUpper(const NodeIndex& node) {
    const auto local = [](std::int32_t v) {
      return static_cast<openvdb::Index>(v & (kChildrenPerAxis - 1));
    };
    return local(node[0]) << 10 | local(node[1]) << 5 | local(node[2]);
  }

  Value valueAt(const std::uint32_t* owner) const { return fill_(owner == nullptr ? 0 : *owner); }

  bool oneValue(const std::uint32_t* owners) const {
    if constexpr (!Fill::kConstant) {
      const Value first = fill_(*owners);
      for (int x = 0; x < kLeafSize; ++x)
        for (int y = 0; y < kLeafSize; ++y)
          for (int z = 0; z < kLeafSize; ++z)
            if (fill_(owners[(x * kNodeSize + y) * kNodeSize + z]) != first)
              return false;
    }
    return true;
  }

  Leaf* makeLeaf(const openvdb::Coord& origin, const LeafRows& rows, int leafZ,
                 const std::uint32_t* owners) const {
    auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), origin, fill_.background, false);
    leaf->allocate();
    auto* data = leaf->buffer().data();
    for (int x = 0; x < kLeafSize; ++x) {
      const std::uint64_t word = rows.word(leafZ, x);
      leaf->getValueMask().template getWord<openvdb::Index64>(static_cast<openvdb::Index>(x)) =
          word;
      if constexpr (std::is_same_v<Value, bool>) {
        data[x] = word; // a bool leaf keeps its values as bits
      } else {
        Value* out = data + x * kLeafSize * kLeafSize;
        for (int i = 0; i < kLeafSize * kLeafSize; ++i) {
          const bool on = (word >> i & 1) != 0;
          if constexpr (Fill::kConstant)
            out[i] = on ? fill_.inside : fill_.background;
          else
            out[i] = on ? fill_(owners[(x * kNodeSize + i / kLeafSize) * kNodeSize + i % kLeafSize])
                        : fill_.background;
        }
      }
    }
    return leaf.release();
  }

  std::string name_;
  openvdb::GridClass class_;
  Fill fill_;
  tbb::enumerable_thread_specific<std::vector<Part>> parts_;
  tbb::enumerable_thread_specific<std::vector<Run>> runs_;
};

// One lower node a grid.
struct TreeBuilder::TreeNode : NodeSink::Node {
  TreeNode(TreeBuilder& owner, const NodeIndex& where) : builder(owner), index(where) {
    trees.reserve(owner.builders_.size());
    for (const auto& grid : owner.builders_)
      trees.push_back(grid->begin(index));
  }
  ~TreeNode() override {
    for (std::size_t i = 0; i < trees.size(); ++i)
      builder.builders_[i]->drop(trees[i]);
  }
  TreeNode(const TreeNode&) = delete;
  TreeNode& operator=(const TreeNode&) = delete;

  TreeBuilder& builder;
  NodeIndex index;
  std::vector<void*> trees;
};

TreeBuilder::TreeBuilder(const std::vector<GridKind>& kinds, const TetMesh& mesh) {
  const CellFill cell{mesh.cellOfTet.empty() ? nullptr : mesh.cellOfTet.data()};
  for (GridKind kind : kinds) {
    switch (kind) {
    case GridKind::Density:
      builders_.push_back(std::make_unique<TypedBuilder<openvdb::FloatTree, ConstantFill<float>>>(
          "density", openvdb::GRID_FOG_VOLUME, ConstantFill<float>{1.0f, 0.0f}));
      break;
    case GridKind::Mask:
      builders_.push_back(std::make_unique<TypedBuilder<openvdb::BoolTree, ConstantFill<bool>>>(
          "mask", openvdb::GRID_UNKNOWN, ConstantFill<bool>{true, false}));
      break;
    case GridKind::TetId:
      builders_.push_back(std::make_unique<TypedBuilder<openvdb::Int32Tree, CellFill>>(
          "tet_id", openvdb::GRID_UNKNOWN, cell));
      break;
    case GridKind::Material:
      builders_.push_back(std::make_unique<TypedBuilder<openvdb::Int32Tree, RegionFill>>(
          "material", openvdb::GRID_UNKNOWN,
          RegionFill{cell, mesh.regions.empty() ? nullptr : mesh.regions.data()}));
      break;
    }
  }
}

TreeBuilder::~TreeBuilder() = default;

std::unique_ptr<NodeSink::Node> TreeBuilder::begin(const NodeIndex& index) {
  return std::make_unique<TreeNode>(*this, index);
}

void TreeBuilder::slab(Node& node, int index, const SlabBits& bits, const std::uint32_t* owners) {
  auto& trees = static_cast<TreeNode&>(node).trees;
  for (std::size_t i = 0; i < builders_.size(); ++i)
    builders_[i]->slab(trees[i], index, bits, owners);
}

void TreeBuilder::end(std::unique_ptr<Node> node) {
  auto& done = static_cast<TreeNode&>(*node);
  for (std::size_t i = 0; i < builders_.size(); ++i)
    builders_[i]->end(std::exchange(done.trees[i], nullptr), done.index);
}

void TreeBuilder::fullRun(std::int32_t x, std::int32_t y, std::int32_t zBegin, std::int32_t zEnd) {
  for (const auto& builder : builders_)
    builder->fullRun({x, y, zBegin, zEnd});
}

void TreeBuilder::fullNode(const NodeIndex& node, std::uint32_t owner) {
  for (const auto& builder : builders_)
    builder->fullNode(node, owner);
}

openvdb::GridPtrVec TreeBuilder::finish(const GridTransform& transform) {
  openvdb::GridPtrVec grids;
  for (const auto& builder : builders_)
    grids.push_back(builder->finish(transform));
  return grids;
}

} // namespace tetvdb
