// SPDX-License-Identifier: Apache-2.0
//
// The grid types that have typed code, and the nodes of their trees in file order. Internal.
#pragma once

#include "tetvdb/volume/Grids.h"

#include <cstddef>
#include <openvdb/openvdb.h>
#include <string>
#include <tbb/parallel_for.h>
#include <type_traits>
#include <vector>

namespace tetvdb {

/// All of them have the tree 5-4-3: root, upper nodes (4096^3), lower nodes (128^3), leaves (8^3).
using KnownGrids = openvdb::TypeList<openvdb::FloatGrid, openvdb::BoolGrid, openvdb::Int32Grid,
                                     openvdb::Vec3SGrid, openvdb::DoubleGrid, openvdb::Int64Grid,
                                     openvdb::MaskGrid, openvdb::Vec3DGrid, openvdb::Vec3IGrid>;

/// Calls `f(grid)` with the grid's own type; false where that is not one of KnownGrids.
template <class F>
bool withKnownGrid(const openvdb::GridBase& grid, F&& f) {
  return grid.apply<KnownGrids>(f);
}
template <class F>
bool withKnownGrid(openvdb::GridBase& grid, F&& f) {
  return grid.apply<KnownGrids>(f);
}

/// Leaves that keep their values as bits.
template <class Tree>
constexpr bool hasBitLeaves = std::is_same<typename Tree::ValueType, bool>::value;

/// Pointers to the nodes of a tree, each level in depth-first order: the order of a .vdb file.
template <class TreeT>
struct NodeLists {
  using Leaf = typename TreeT::LeafNodeType;
  using Upper = typename TreeT::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;

  std::vector<const Upper*> uppers;
  std::vector<const Lower*> lowers;

  explicit NodeLists(const TreeT& tree) {
    for (auto child = tree.root().cbeginChildOn(); child; ++child)
      uppers.push_back(&*child);
    std::vector<std::size_t> first(uppers.size() + 1, 0);
    for (std::size_t i = 0; i < uppers.size(); ++i)
      first[i + 1] = first[i] + uppers[i]->getChildMask().countOn();
    lowers.resize(first.back());
    tbb::parallel_for(std::size_t(0), uppers.size(), [&](std::size_t i) {
      std::size_t next = first[i];
      for (auto child = uppers[i]->cbeginChildOn(); child; ++child)
        lowers[next++] = &*child;
    });
  }

  std::vector<const Leaf*> leaves() const {
    std::vector<std::size_t> first(lowers.size() + 1, 0);
    tbb::parallel_for(std::size_t(0), lowers.size(),
                      [&](std::size_t i) { first[i + 1] = lowers[i]->getChildMask().countOn(); });
    for (std::size_t i = 0; i < lowers.size(); ++i)
      first[i + 1] += first[i];
    std::vector<const Leaf*> result(first.back());
    tbb::parallel_for(std::size_t(0), lowers.size(), [&](std::size_t i) {
      std::size_t next = first[i];
      for (auto child = lowers[i]->cbeginChildOn(); child; ++child)
        result[next++] = &*child;
    });
    return result;
  }
};

/// Bytes that are equal if and only if two transforms are the same map, whatever its class: the
/// matrix where it is linear, else its type and serialized form.
std::string canonicalBytes(const openvdb::math::Transform& transform);

} // namespace tetvdb
