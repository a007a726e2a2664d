// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/arrays/MakeDenseGrid.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cstring>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <type_traits>

namespace tetvdb {
namespace {

constexpr std::int32_t kLeafSide = 8;

// How a voxel's value is stored in an array.
template <typename Value>
struct Stored {
  using Element = Value;
  static constexpr std::size_t kComponents = 1;
};
template <>
struct Stored<bool> {
  using Element = std::uint8_t;
  static constexpr std::size_t kComponents = 1;
};
template <typename Number>
struct Stored<openvdb::math::Vec3<Number>> {
  using Element = Number;
  static constexpr std::size_t kComponents = 3;
};

template <typename Element>
constexpr ElementType elementType() {
  if constexpr (std::is_same_v<Element, std::uint8_t>)
    return ElementType::UInt8;
  else if constexpr (std::is_same_v<Element, std::int32_t>)
    return ElementType::Int32;
  else if constexpr (std::is_same_v<Element, std::int64_t>)
    return ElementType::Int64;
  else if constexpr (std::is_same_v<Element, float>)
    return ElementType::Float32;
  else {
    static_assert(std::is_same_v<Element, double>);
    return ElementType::Float64;
  }
}

std::int32_t leafOrigin(std::int32_t voxel) {
  return voxel & ~(kLeafSide - 1);
}

// First voxels of the leaf nodes that low to high pass through.
std::size_t leavesAlong(std::int32_t low, std::int32_t high) {
  return static_cast<std::size_t>((static_cast<std::int64_t>(leafOrigin(high)) - leafOrigin(low)) /
                                  kLeafSide) +
         1;
}

template <typename GridT>
class TypedGrid final : public DenseGrid {
  using Tree = typename GridT::TreeType;
  using Leaf = typename Tree::LeafNodeType;
  using Value = typename Tree::ValueType;
  using Element = typename Stored<Value>::Element;
  static constexpr std::size_t kComponents = Stored<Value>::kComponents;
  static constexpr std::size_t kBytes = kComponents * sizeof(Element);
  static constexpr bool kBits = hasBitLeaves<Tree>;

public:
  TypedGrid(const GridT& grid, const VoxelBox& box) : tree_(grid.constTree()) {
    name_ = grid.getName();
    element_ = elementType<Element>();
    components_ = kComponents;
    isBits_ = kBits;
    box_ = box;
  }

  void fill(const AxisOrder& order, std::uint64_t first, std::uint64_t count,
            void* out) const override {
    Slab slab;
    slab.order = order;
    slab.box = box_;
    slab.box.low[order[0]] += static_cast<std::int32_t>(first);
    slab.box.high[order[0]] = slab.box.low[order[0]] + static_cast<std::int32_t>(count) - 1;
    slab.step[order[2]] = kBytes;
    slab.step[order[1]] = kBytes * slab.box.size(order[2]);
    slab.step[order[0]] = slab.step[order[1]] * slab.box.size(order[1]);
    slab.out = static_cast<char*>(out);
    const std::size_t axis = order[1];
    const std::size_t rows = leavesAlong(slab.box.low[axis], slab.box.high[axis]);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows), [&](const auto& range) {
      openvdb::tree::ValueAccessor<const Tree> accessor(tree_);
      for (std::size_t row = range.begin(); row != range.end(); ++row)
        fillRow(slab, static_cast<std::int32_t>(row), accessor);
    });
  }

  std::uint64_t countActive() const override {
    // Clips nodes itself, so that whole nodes are counted by their masks.
    std::uint64_t sum = 0;
    const openvdb::CoordBBox box(openvdb::Coord(box_.low.data()), openvdb::Coord(box_.high.data()));
    openvdb::CoordBBox all;
    if (!tree_.evalActiveVoxelBoundingBox(all))
      return 0;
    if (box.isInside(all))
      return tree_.activeVoxelCount();
    for (auto leaf = tree_.cbeginLeaf(); leaf; ++leaf) {
      const openvdb::CoordBBox own = leaf->getNodeBoundingBox();
      if (box.isInside(own))
        sum += leaf->onVoxelCount();
      else if (box.hasOverlap(own))
        for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel)
          sum += box.isInside(voxel.getCoord()) ? 1 : 0;
    }
    auto tile = tree_.cbeginValueOn();
    tile.setMaxDepth(Tree::ValueOnCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
      openvdb::CoordBBox own;
      tile.getBoundingBox(own);
      own.intersect(box);
      sum += own.empty() ? 0 : own.volume();
    }
    return sum;
  }

  void activeOf(std::uint64_t plane, std::vector<std::int32_t>* voxels,
                std::vector<char>* values) const override {
    const auto x = static_cast<std::int32_t>(box_.low[0] + static_cast<std::int64_t>(plane));
    const std::size_t rows = leavesAlong(box_.low[1], box_.high[1]);
    std::vector<Row> made(rows);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows), [&](const auto& range) {
      openvdb::tree::ValueAccessor<const Tree> accessor(tree_);
      for (std::size_t row = range.begin(); row != range.end(); ++row)
        activeOfRow(x, static_cast<std::int32_t>(row), voxels != nullptr, values != nullptr,
                    accessor, made[row]);
    });
    for (const Row& row : made) {
      if (voxels != nullptr)
        voxels->insert(voxels->end(), row.voxels.begin(), row.voxels.end());
      if (values != nullptr)
        values->insert(values->end(), row.values.begin(), row.values.end());
    }
  }

  std::vector<char> background() const override {
    std::vector<char> bytes(kBytes);
    put(tree_.background(), bytes.data());
    return bytes;
  }

private:
  struct Slab {
    AxisOrder order{};
    VoxelBox box;
    std::array<std::size_t, 3> step{}; ///< bytes from a voxel to the next along an axis
    char* out = nullptr;
  };
  struct Row {
    std::vector<std::int32_t> voxels;
    std::vector<char> values;
  };
  using Accessor = openvdb::tree::ValueAccessor<const Tree>;

  static void put(const Value& value, char* out) {
    if constexpr (kComponents == 1) {
      const auto element = static_cast<Element>(value);
      std::memcpy(out, &element, sizeof element);
    } else {
      std::memcpy(out, value.asPointer(), kBytes);
    }
  }

  static Value valueOf(const Leaf& leaf, openvdb::Index voxel) {
    if constexpr (kBits)
      return leaf.getValue(voxel);
    else
      return leaf.buffer().data()[voxel];
  }

  // The voxels of leaf nodes in one row of them along order[2], for all of the slab's order[0].
  void fillRow(const Slab& slab, std::int32_t row, Accessor& accessor) const {
    const auto [slow, midpoint, fast] = slab.order;
    VoxelBox part = slab.box;
    const std::int32_t start = leafOrigin(slab.box.low[midpoint]) + row * kLeafSide;
    part.low[midpoint] = std::max(start, slab.box.low[midpoint]);
    part.high[midpoint] = std::min(start + kLeafSide - 1, slab.box.high[midpoint]);
    const std::size_t along = leavesAlong(slab.box.low[fast], slab.box.high[fast]);
    const std::size_t across = leavesAlong(slab.box.low[slow], slab.box.high[slow]);
    for (std::size_t i = 0; i < across; ++i) {
      const std::int32_t s =
          leafOrigin(slab.box.low[slow]) + static_cast<std::int32_t>(i) * kLeafSide;
      part.low[slow] = std::max(s, slab.box.low[slow]);
      part.high[slow] = std::min(s + kLeafSide - 1, slab.box.high[slow]);
      for (std::size_t j = 0; j < along; ++j) {
        const std::int32_t f =
            leafOrigin(slab.box.low[fast]) + static_cast<std::int32_t>(j) * kLeafSide;
        part.low[fast] = std::max(f, slab.box.low[fast]);
        part.high[fast] = std::min(f + kLeafSide - 1, slab.box.high[fast]);
        fillPart(slab, part, accessor);
      }
    }
  }

  // `part` is of one leaf node.
  void fillPart(const Slab& slab, const VoxelBox& part, Accessor& accessor) const {
    const openvdb::Coord first(part.low.data());
    const auto [slow, midpoint, fast] = slab.order;
    const std::size_t run = static_cast<std::size_t>(part.size(fast));
    char* corner = slab.out;
    for (std::size_t axis = 0; axis < 3; ++axis)
      corner += slab.step[axis] * static_cast<std::size_t>(part.low[axis] - slab.box.low[axis]);
    const Leaf* leaf = accessor.probeConstLeaf(first);
    constexpr openvdb::Index kSteps[3] = {kLeafSide * kLeafSide, kLeafSide, 1};
    const openvdb::Index start = leaf == nullptr ? 0 : Leaf::coordToOffset(first);
    const Value tile = leaf == nullptr ? accessor.getValue(first) : Value();
    for (std::uint64_t s = 0; s < part.size(slow); ++s)
      for (std::uint64_t m = 0; m < part.size(midpoint); ++m) {
        char* out = corner + s * slab.step[slow] + m * slab.step[midpoint];
        if (leaf == nullptr) {
          for (std::size_t i = 0; i < run; ++i)
            put(tile, out + i * kBytes);
          continue;
        }
        const openvdb::Index from = start + static_cast<openvdb::Index>(s) * kSteps[slow] +
                                    static_cast<openvdb::Index>(m) * kSteps[midpoint];
        for (std::size_t i = 0; i < run; ++i)
          put(valueOf(*leaf, from + static_cast<openvdb::Index>(i) * kSteps[fast]),
              out + i * kBytes);
      }
  }

  void activeOfRow(std::int32_t x, std::int32_t row, bool wantsVoxels, bool wantsValues,
                   Accessor& accessor, Row& out) const {
    const std::int32_t start = leafOrigin(box_.low[1]) + row * kLeafSide;
    const std::int32_t last = std::min(start + kLeafSide - 1, box_.high[1]);
    char value[kBytes];
    const auto add = [&](std::int32_t y, std::int32_t z, const Value& v) {
      if (wantsVoxels)
        out.voxels.insert(out.voxels.end(), {x, y, z});
      if (wantsValues) {
        put(v, value);
        out.values.insert(out.values.end(), value, value + kBytes);
      }
    };
    const std::size_t along = leavesAlong(box_.low[2], box_.high[2]);
    for (std::int32_t y = std::max(start, box_.low[1]); y <= last; ++y)
      for (std::size_t j = 0; j < along; ++j) {
        const std::int32_t z = leafOrigin(box_.low[2]) + static_cast<std::int32_t>(j) * kLeafSide;
        const std::int32_t from = std::max(z, box_.low[2]);
        const std::int32_t to = std::min(z + kLeafSide - 1, box_.high[2]);
        const openvdb::Coord first(x, y, from);
        if (const Leaf* leaf = accessor.probeConstLeaf(first)) {
          const openvdb::Index offset = Leaf::coordToOffset(first);
          for (std::int32_t k = from; k <= to; ++k) {
            const openvdb::Index voxel = offset + static_cast<openvdb::Index>(k - from);
            if (leaf->isValueOn(voxel))
              add(y, k, valueOf(*leaf, voxel));
          }
        } else if (Value tile; accessor.probeValue(first, tile)) {
          for (std::int32_t k = from; k <= to; ++k)
            add(y, k, tile);
        }
      }
  }

  const Tree& tree_;
};

} // namespace

std::unique_ptr<DenseGrid> denseGrid(const openvdb::GridBase& grid, const VoxelBox& box) {
  std::unique_ptr<DenseGrid> dense;
  const bool known = withKnownGrid(grid, [&](const auto& typed) {
    dense = std::make_unique<TypedGrid<std::decay_t<decltype(typed)>>>(typed, box);
  });
  if (!known)
    throw Error(Status::Usage, grid.getName(),
                "grids of type " + grid.type() + " do not become arrays",
                "choose others with `grid`");
  return dense;
}

} // namespace tetvdb
