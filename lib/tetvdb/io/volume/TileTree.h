// SPDX-License-Identifier: Apache-2.0
//
// Cubes of trees, copied node by node.
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

/// Whether a node has children, or tiles but inactive ones of the background's value.
template <class Node, class T>
bool holdsAnything(const Node& node, const T& background) {
  if (!node.getChildMask().isOff() || !node.getValueMask().isOff())
    return true;
  for (openvdb::Index n = 0; n < Node::NUM_VALUES; ++n)
    if (T(node.getTable()[n].getValue()) != background)
      return true;
  return false;
}

/// Copies the voxels of a cube at `corner` into the empty grid `to`: 128 to 4096 voxels along a
/// side, in one child of the root node. False where it has none but inactive ones of the
/// background's value; `to` is empty then.
template <class GridT>
bool copyCube(const GridT& from, const openvdb::Coord& corner, std::int32_t size, GridT& to) {
  using TreeT = typename GridT::TreeType;
  using Upper = typename NodeLists<TreeT>::Upper;
  using Lower = typename NodeLists<TreeT>::Lower;
  using T = typename TreeT::ValueType;
  constexpr std::int32_t kAll = Upper::DIM, kNode = Lower::DIM;
  const T background = from.background();
  auto& root = to.tree().root();
  const Upper* upper = from.constTree().template probeConstNode<Upper>(corner);
  T tile{};
  const bool tileActive = upper == nullptr && from.constTree().probeValue(corner, tile);
  if (upper == nullptr && !tileActive && tile == background)
    return false;
  if (size == kAll) {
    if (upper != nullptr && !holdsAnything(*upper, background))
      return false;
    if (upper != nullptr)
      root.addChild(new Upper(*upper));
    else
      root.addTile(corner, tile, tileActive);
    return true;
  }
  auto node = std::make_unique<Upper>(corner, background, false);
  bool any = false;
  for (std::int32_t x = 0; x < size; x += kNode)
    for (std::int32_t y = 0; y < size; y += kNode)
      for (std::int32_t z = 0; z < size; z += kNode) {
        const openvdb::Index n = Upper::coordToOffset(corner.offsetBy(x, y, z));
        if (upper != nullptr && upper->isChildMaskOn(n)) {
          node->addChild(new Lower(*upper->getTable()[n].getChild()));
          any = true;
          continue;
        }
        const T value = upper == nullptr ? tile : T(upper->getTable()[n].getValue());
        const bool active = upper == nullptr ? tileActive : upper->isValueMaskOn(n);
        if (!active && value == background)
          continue;
        node->addTile(n, value, active);
        any = true;
      }
  if (any)
    root.addChild(node.release());
  return any;
}

/// Copies the active voxels of a cube into the empty grid `to`, whose tree is pruned: a power of
/// two along a side, below 4096, at multiples of that.
template <class GridT>
void copyActive(const GridT& from, const openvdb::Coord& corner, std::int32_t side, GridT& to) {
  const std::int32_t size = std::max(side, kNodeSize);
  if (!copyCube(from, corner & ~(size - 1), size, to) || side == size)
    return;
  to.tree().clip(openvdb::CoordBBox::createCube(corner, side));
  openvdb::tools::prune(to.tree());
}

/// Moves what a grid has in `box`, which lies in one child of the root node, into the empty grid
/// `to`: of the nodes in `box` nothing stays but their place. False where it has none but inactive
/// voxels of the background's value; `to` is empty then.
template <class GridT>
bool takeNodes(GridT& from, const NodeBox& box, GridT& to) {
  using TreeT = typename GridT::TreeType;
  using Upper = typename NodeLists<TreeT>::Upper;
  using Lower = typename NodeLists<TreeT>::Lower;
  using T = typename TreeT::ValueType;
  const T background = from.background();
  const auto isEntry = [&](const T& value, bool active) {
    return active || std::memcmp(&value, &background, sizeof(T)) != 0;
  };
  const openvdb::Coord corner(box.low[0] * kNodeSize, box.low[1] * kNodeSize,
                              box.low[2] * kNodeSize);
  Upper* upper = from.tree().template probeNode<Upper>(corner);
  T tile{};
  const bool tileActive = upper == nullptr && from.constTree().probeValue(corner, tile);
  if (upper == nullptr && !isEntry(tile, tileActive))
    return false;
  if (upper == nullptr && box.high[0] - box.low[0] == kRootChildSize / kNodeSize &&
      box.high[1] - box.low[1] == kRootChildSize / kNodeSize &&
      box.high[2] - box.low[2] == kRootChildSize / kNodeSize) {
    to.tree().root().addTile(corner, tile, tileActive);
    return true;
  }
  auto node = std::make_unique<Upper>(corner, background, false);
  bool any = false;
  for (std::int32_t x = box.low[0]; x < box.high[0]; ++x)
    for (std::int32_t y = box.low[1]; y < box.high[1]; ++y)
      for (std::int32_t z = box.low[2]; z < box.high[2]; ++z) {
        const openvdb::Coord at(x * kNodeSize, y * kNodeSize, z * kNodeSize);
        const openvdb::Index n = Upper::coordToOffset(at);
        if (upper != nullptr && upper->isChildMaskOn(n)) {
          node->addChild(upper->template stealNode<Lower>(at, background, false));
          any = true;
          continue;
        }
        const T value = upper == nullptr ? tile : T(upper->getTable()[n].getValue());
        const bool active = upper == nullptr ? tileActive : upper->isValueMaskOn(n);
        if (!isEntry(value, active))
          continue;
        node->addTile(n, value, active);
        any = true;
      }
  if (any)
    to.tree().root().addChild(node.release());
  return any;
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
