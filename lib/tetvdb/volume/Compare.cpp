// SPDX-License-Identifier: Apache-2.0
//
// Traverses two trees together. Where one tree has a tile and the other a node, the tile is
// compared with all values below the node; a voxel outside both trees is an inactive tile of the
// background.
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/SumComparisons.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace tetvdb {
namespace {

/// What a voxel, a tile or the space outside a tree holds.
template <class T>
struct Cell {
  T value{};
  bool active = false;
};

template <class T>
double difference(const T& a, const T& b) {
  double result = 0;
  if constexpr (openvdb::VecTraits<T>::IsVec) {
    for (int i = 0; i < openvdb::VecTraits<T>::Size; ++i) {
      const double d = double(a[i]) - double(b[i]);
      result += d * d;
    }
    result = std::sqrt(result);
  } else if constexpr (std::is_integral<T>::value && !std::is_same<T, bool>::value) {
    using Unsigned = std::make_unsigned_t<T>;
    result =
        double(a > b ? Unsigned(Unsigned(a) - Unsigned(b)) : Unsigned(Unsigned(b) - Unsigned(a)));
  } else {
    result = std::abs(double(a) - double(b));
  }
  return result == result ? result
                          : std::numeric_limits<double>::infinity(); // NaN against a number
}

template <class T>
bool sameValue(const T& a, const T& b) {
  return a == b || std::memcmp(&a, &b, sizeof a) == 0; // 0 and -0; NaN of the same bits
}

template <class TreeT>
class Comparer {
public:
  using T = typename TreeT::ValueType;
  using Root = typename TreeT::RootNodeType;
  using Upper = typename Root::ChildNodeType;

  Comparer(const TreeT& a, const TreeT& b)
      : a_(a), b_(b), backgroundA_(a.background()), backgroundB_(b.background()) {}

  GridComparison run() const {
    GridComparison result;
    std::set<openvdb::Coord> origins;
    for (const TreeT* tree : {&a_, &b_})
      for (auto entry = tree->root().cbeginChildAll(); entry; ++entry)
        origins.insert(entry.getCoord());
    for (const openvdb::Coord& origin : origins) {
      const auto [nodeA, cellA] = entryAt(a_, origin);
      const auto [nodeB, cellB] = entryAt(b_, origin);
      add(result, compareUpper(nodeA, nodeB, cellA, cellB));
    }
    return result;
  }

private:
  std::pair<const Upper*, Cell<T>> entryAt(const TreeT& tree, const openvdb::Coord& origin) const {
    const Upper* node = tree.template probeConstNode<Upper>(origin);
    Cell<T> cell;
    if (!node)
      cell.active = tree.probeValue(origin, cell.value);
    return {node, cell};
  }

  void cells(GridComparison& sum, const Cell<T>& a, const Cell<T>& b, std::uint64_t voxels) const {
    if (!a.active && !b.active)
      return;
    if (a.active)
      sum.activeA += voxels;
    if (b.active)
      sum.activeB += voxels;
    if (a.active && b.active) {
      sum.activeBoth += voxels;
      if (sameValue(a.value, b.value))
        return;
      sum.valueDiffers += voxels;
    } else {
      sum.stateDiffers += voxels;
    }
    const double d =
        difference(a.active ? a.value : backgroundA_, b.active ? b.value : backgroundB_);
    sum.largestDifference = std::max(sum.largestDifference, d);
  }

  GridComparison compareUpper(const Upper* a, const Upper* b, const Cell<T>& cellA,
                              const Cell<T>& cellB) const {
    if (!a && !b) {
      GridComparison sum;
      cells(sum, cellA, cellB, Upper::NUM_VOXELS);
      return sum;
    }
    return tbb::parallel_reduce(
        tbb::blocked_range<openvdb::Index>(0, Upper::NUM_VALUES, 64), GridComparison{},
        [&](const auto& range, GridComparison sum) {
          for (openvdb::Index i = range.begin(); i < range.end(); ++i)
            child(sum, a, b, cellA, cellB, i);
          return sum;
        },
        [](GridComparison left, const GridComparison& right) {
          add(left, right);
          return left;
        });
  }

  /// Entry `i` of two internal nodes; a missing node has the cell's value everywhere.
  template <class Node>
  void child(GridComparison& sum, const Node* a, const Node* b, const Cell<T>& cellA,
             const Cell<T>& cellB, openvdb::Index i) const {
    using Child = typename Node::ChildNodeType;
    Cell<T> belowA = cellA, belowB = cellB;
    const Child* childA = a ? entry(*a, i, belowA) : nullptr;
    const Child* childB = b ? entry(*b, i, belowB) : nullptr;
    if (!childA && !childB)
      cells(sum, belowA, belowB, Child::NUM_VOXELS);
    else
      nodes(sum, childA, childB, belowA, belowB);
  }

  template <class Node>
  static const typename Node::ChildNodeType* entry(const Node& node, openvdb::Index i,
                                                   Cell<T>& cell) {
    if (node.getChildMask().isOn(i))
      return node.getTable()[i].getChild();
    cell = {T(node.getTable()[i].getValue()), node.getValueMask().isOn(i)};
    return nullptr;
  }

  template <class Node>
  void nodes(GridComparison& sum, const Node* a, const Node* b, const Cell<T>& cellA,
             const Cell<T>& cellB) const {
    if constexpr (Node::LEVEL > 0) {
      for (openvdb::Index i = 0; i < Node::NUM_VALUES; ++i)
        child(sum, a, b, cellA, cellB, i);
    } else {
      if (a && b && sameLeaf(*a, *b)) {
        const auto active = a->getValueMask().countOn();
        sum.activeA += active;
        sum.activeB += active;
        sum.activeBoth += active;
        return;
      }
      const auto at = [](const Node* leaf, const Cell<T>& cell, openvdb::Index i) {
        return leaf ? Cell<T>{T(leaf->getValue(i)), leaf->isValueOn(i)} : cell;
      };
      for (openvdb::Index i = 0; i < Node::SIZE; ++i)
        cells(sum, at(a, cellA, i), at(b, cellB, i), 1);
    }
  }

  /// True if masks and values are the same bits: the usual case, compared at memory bandwidth.
  template <class Leaf>
  static bool sameLeaf(const Leaf& a, const Leaf& b) {
    constexpr std::size_t size = hasBitLeaves<TreeT> ? Leaf::SIZE / 8 : Leaf::SIZE * sizeof(T);
    return a.getValueMask() == b.getValueMask() &&
           std::memcmp(a.buffer().data(), b.buffer().data(), size) == 0;
  }

  const TreeT& a_;
  const TreeT& b_;
  const T backgroundA_, backgroundB_;
};

/// False where the grids hold other types of values, or one that has no typed code.
bool comparePair(const openvdb::GridBase& a, const openvdb::GridBase& b, GridComparison& result) {
  if (a.type() != b.type())
    return false;
  return withKnownGrid(a, [&](const auto& typed) {
    using GridT = std::decay_t<decltype(typed)>;
    const auto& other = static_cast<const GridT&>(b);
    result = Comparer<typename GridT::TreeType>(typed.constTree(), other.constTree()).run();
  });
}

} // namespace

bool VolumeComparison::same() const {
  if (!onlyA.empty() || !onlyB.empty() || !incomparable.empty() || !sameTransform)
    return false;
  return std::all_of(grids.begin(), grids.end(), [](const GridComparison& grid) {
    return grid.stateDiffers == 0 && grid.valueDiffers == 0;
  });
}

VolumeComparison compareVolumes(const Volume& a, const Volume& b) {
  VolumeComparison result;
  std::vector<openvdb::GridBase::Ptr> unmatched = b.grids().all;
  for (const auto& gridA : a.grids().all) {
    const std::string name = gridA->getName();
    const auto found = std::find_if(unmatched.begin(), unmatched.end(),
                                    [&](const auto& grid) { return grid->getName() == name; });
    if (found == unmatched.end()) {
      result.onlyA.push_back(name);
      continue;
    }
    const openvdb::GridBase::Ptr gridB = *found;
    unmatched.erase(found);
    GridComparison comparison;
    if (comparePair(*gridA, *gridB, comparison)) {
      comparison.name = name;
      result.grids.push_back(comparison);
      if (canonicalBytes(gridA->transform()) != canonicalBytes(gridB->transform()))
        result.sameTransform = false;
    } else {
      result.incomparable.push_back(name);
    }
  }
  for (const auto& grid : unmatched)
    result.onlyB.push_back(grid->getName());
  result.sameHash = hash(a) == hash(b);
  return result;
}

} // namespace tetvdb
