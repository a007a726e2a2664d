// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/TreeBuilder.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/volume/TreeAssembly.h"
#include "tetvdb/voxelize/LeafRows.h"

#include <utility>

namespace tetvdb {
namespace {

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
  const std::uint32_t* numbers;   // of cells; null: their places
  std::int32_t background = -1;
  static constexpr bool kConstant = false;
  std::uint32_t cell(std::uint32_t tet) const {
    return cellOfTet != nullptr ? cellOfTet[tet] : tet;
  }
  std::int32_t operator()(std::uint32_t tet) const {
    return static_cast<std::int32_t>(numbers != nullptr ? numbers[cell(tet)] : cell(tet));
  }
};

// The value is the region number of that cell.
struct RegionFill {
  CellFill cells;
  const std::int32_t* regions; // null: 0 throughout
  std::int32_t background = -1;
  static constexpr bool kConstant = false;
  std::int32_t operator()(std::uint32_t tet) const {
    return regions != nullptr ? regions[cells.cell(tet)] : 0;
  }
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
  virtual void fullRun(const NodeRun& run) = 0;
  virtual void fullNode(const NodeIndex& node, std::uint32_t owner) = 0;
  virtual openvdb::GridBase::Ptr finish(const GridTransform& transform) = 0;
};

template <typename TreeType, typename Fill>
class TreeBuilder::TypedBuilder : public TreeBuilder::GridBuilder {
  using Leaf = typename TreeType::LeafNodeType;
  using Lower = typename TreeAssembly<TreeType>::Lower;
  using Value = typename TreeType::ValueType;

public:
  TypedBuilder(GridKind kind, Fill fill)
      : kind_(kind), fill_(std::move(fill)), assembly_(fill_.background) {}

  void* begin(const NodeIndex& node) override { return assembly_.begin(node).release(); }

  void slab(void* node, int index, const SlabBits& bits, const std::uint32_t* owners) override {
    auto* lower = static_cast<Lower*>(node);
    const openvdb::Coord corner = lower->origin().offsetBy(index * kLeafSize, 0, 0);
    eachLeaf(bits, index, [&](const LeafRows& rows, int leafY, int leafZ, int entry) {
      const std::uint32_t* first =
          owners == nullptr ? nullptr
                            : owners + (leafY * kLeafSize * kNodeSize + leafZ * kLeafSize);
      if (rows.full(leafZ) && oneValue(first))
        lower->addTile(static_cast<openvdb::Index>(entry), valueAt(first), true);
      else
        lower->addLeaf(
            makeLeaf(corner.offsetBy(0, leafY * kLeafSize, leafZ * kLeafSize), rows, leafZ, first));
    });
  }

  void end(void* node, const NodeIndex& index) override {
    assembly_.end(std::unique_ptr<Lower>(static_cast<Lower*>(node)), index);
  }

  void drop(void* node) override { delete static_cast<Lower*>(node); }

  void fullRun(const NodeRun& run) override { assembly_.tiles(run, fill_(0)); }

  void fullNode(const NodeIndex& node, std::uint32_t owner) override {
    assembly_.tile(node, fill_(owner));
  }

  openvdb::GridBase::Ptr finish(const GridTransform& transform) override {
    const GridKindInfo& info = infoOf(kind_);
    return assembly_.finish(std::string(info.name),
                            openvdb::GridBase::stringToGridClass(std::string(info.gridClass)),
                            transform);
  }

private:
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

  GridKind kind_;
  Fill fill_;
  TreeAssembly<TreeType> assembly_;
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

TreeBuilder::TreeBuilder(const std::vector<GridKind>& kinds, const TetMesh& mesh,
                         const std::vector<std::uint32_t>* cellNumbers) {
  const CellFill cell{mesh.cellOfTet.empty() ? nullptr : mesh.cellOfTet.data(),
                      cellNumbers == nullptr ? nullptr : cellNumbers->data()};
  for (GridKind kind : kinds) {
    switch (kind) {
    case GridKind::Density:
      builders_.push_back(std::make_unique<TypedBuilder<openvdb::FloatTree, ConstantFill<float>>>(
          kind, ConstantFill<float>{1.0f, 0.0f}));
      break;
    case GridKind::Mask:
      builders_.push_back(std::make_unique<TypedBuilder<openvdb::BoolTree, ConstantFill<bool>>>(
          kind, ConstantFill<bool>{true, false}));
      break;
    case GridKind::TetId:
      builders_.push_back(std::make_unique<TypedBuilder<openvdb::Int32Tree, CellFill>>(kind, cell));
      break;
    case GridKind::Material:
      builders_.push_back(std::make_unique<TypedBuilder<openvdb::Int32Tree, RegionFill>>(
          kind, RegionFill{cell, mesh.regions.empty() ? nullptr : mesh.regions.data()}));
      break;
    default:
      throw Error(Status::Usage, infoOf(kind).name, "is no grid of occupancy or owners");
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
