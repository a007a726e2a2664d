// SPDX-License-Identifier: Apache-2.0
//
// Parts of trees, node by node.
#pragma once

#include "tetvdb/geometry/NodeBox.h"
#include "tetvdb/volume/GridStatistics.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <openvdb/tools/Prune.h>
#include <set>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {

/// A grid without voxels that has all else of `grid`, but its tree's statistics.
template <class GridT>
typename GridT::Ptr emptyLike(const GridT& grid) {
  auto copy = GridT::create(grid.background());
  copy->insertMeta(grid);
  removeStatistics(*copy);
  copy->setTransform(std::const_pointer_cast<openvdb::math::Transform>(grid.transformPtr()));
  return copy;
}

/// Gives the empty grid `to` what `from` has in `box`, which lies in one child of the root node:
/// entries of that child, or its tile where `box` is all of it. lowersOf(upper, entries): the lower
/// nodes at these entries. False where there is nothing but inactive voxels of the background's
/// value; `to` is empty then.
template <class From, class GridT, class LowersOf>
bool joinNodes(From& from, const NodeBox& box, GridT& to, const LowersOf& lowersOf) {
  using Upper = typename NodeLists<typename GridT::TreeType>::Upper;
  using T = typename GridT::ValueType;
  const T background = from.background();
  const auto isEntry = [&](const T& value, bool active) {
    return active || std::memcmp(&value, &background, sizeof(T)) != 0;
  };
  const openvdb::Coord corner(box.low[0] * kNodeSize, box.low[1] * kNodeSize,
                              box.low[2] * kNodeSize);
  auto* upper = from.tree().template probeNode<Upper>(corner);
  T tile{};
  const bool tileActive = upper == nullptr && from.tree().probeValue(corner, tile);
  if (upper == nullptr && !isEntry(tile, tileActive))
    return false;
  bool isWhole = true;
  for (std::size_t k = 0; k < 3; ++k)
    isWhole = isWhole && box.high[k] - box.low[k] == kRootChildSize / kNodeSize;
  if (upper == nullptr && isWhole) {
    to.tree().root().addTile(corner, tile, tileActive);
    return true;
  }
  auto node = std::make_unique<Upper>(corner, background, false);
  std::vector<openvdb::Index> children;
  bool any = false;
  for (std::int32_t x = box.low[0]; x < box.high[0]; ++x)
    for (std::int32_t y = box.low[1]; y < box.high[1]; ++y)
      for (std::int32_t z = box.low[2]; z < box.high[2]; ++z) {
        const openvdb::Index n =
            Upper::coordToOffset(openvdb::Coord(x * kNodeSize, y * kNodeSize, z * kNodeSize));
        if (upper != nullptr && upper->isChildMaskOn(n)) {
          children.push_back(n);
          continue;
        }
        const T value = upper == nullptr ? tile : T(upper->getTable()[n].getValue());
        const bool active = upper == nullptr ? tileActive : upper->isValueMaskOn(n);
        if (!isEntry(value, active))
          continue;
        node->addTile(n, value, active);
        any = true;
      }
  if (!any && children.empty())
    return false;
  if (!children.empty())
    for (auto* lower : lowersOf(*upper, children))
      node->addChild(lower);
  to.tree().root().addChild(node.release());
  return true;
}

/// joinNodes() by copies of the nodes. Parallel.
template <class GridT>
bool copyNodes(const GridT& from, const NodeBox& box, GridT& to) {
  using Lists = NodeLists<typename GridT::TreeType>;
  using Lower = typename Lists::Lower;
  return joinNodes(
      from, box, to,
      [](const typename Lists::Upper& upper, const std::vector<openvdb::Index>& entries) {
        std::vector<Lower*> copies(entries.size());
        tbb::parallel_for(std::size_t(0), entries.size(), [&](std::size_t i) {
          copies[i] = new Lower(*upper.getTable()[entries[i]].getChild());
        });
        return copies;
      });
}

/// joinNodes() by the nodes themselves, in whose place `from` has inactive tiles then.
template <class GridT>
bool takeNodes(GridT& from, const NodeBox& box, GridT& to) {
  using Lists = NodeLists<typename GridT::TreeType>;
  using Lower = typename Lists::Lower;
  return joinNodes(from, box, to,
                   [&](typename Lists::Upper& upper, const std::vector<openvdb::Index>& entries) {
                     std::vector<Lower*> taken;
                     for (const openvdb::Index n : entries)
                       taken.push_back(upper.template stealNode<Lower>(upper.offsetToGlobalCoord(n),
                                                                       from.background(), false));
                     return taken;
                   });
}

/// Nodes from the one at `corner` on, `size` voxels along a side.
inline NodeBox nodesOf(const openvdb::Coord& corner, const openvdb::Coord& size) {
  NodeBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = nodeOf(corner[k]);
    box.high[k] = box.low[k] + size[k] / kNodeSize;
  }
  return box;
}

/// Copies the active voxels of a cube into the empty grid `to`, whose tree is pruned: a power of
/// two along a side, below 4096, at multiples of that.
template <class GridT>
void copyActive(const GridT& from, const openvdb::Coord& corner, std::int32_t side, GridT& to) {
  const std::int32_t size = std::max(side, kNodeSize);
  const NodeBox box = nodesOf(corner & ~(size - 1), openvdb::Coord(size));
  if (!copyNodes(from, box, to) || side == size)
    return;
  to.tree().clip(openvdb::CoordBBox::createCube(corner, side));
  openvdb::tools::prune(to.tree());
}

/// Of all entries of the grids' root nodes but inactive ones of the background's value, by x, then
/// y, then z.
inline std::vector<openvdb::Coord> rootOrigins(const openvdb::GridPtrVec& grids) {
  std::set<openvdb::Coord> origins;
  for (const auto& grid : grids)
    withKnownGrid(std::as_const(*grid), [&](const auto& typed) {
      for (auto entry = typed.constTree().root().cbeginChildAll(); entry; ++entry)
        origins.insert(entry.getCoord());
    });
  return {origins.begin(), origins.end()};
}

} // namespace tetvdb
