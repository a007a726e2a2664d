// SPDX-License-Identifier: Apache-2.0
//
// OpenVDB's nodes as NanoVDB's, with their statistics: the bytes of NanoVDB's own converter, whose
// averages and standard deviations depend in their last bits on how threads share the nodes.
// Internal: instantiates both libraries.
#pragma once

#include "tetvdb/core/NanoVdb.h"
#include TETVDB_NANOVDB_TOOL(GridStats)

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <openvdb/openvdb.h>
#include <tbb/cache_aligned_allocator.h>
#include <type_traits>
#include <vector>

namespace tetvdb {

/// Nodes of NanoVDB lie at multiples of 32 bytes.
using NodeMemory = std::vector<unsigned char, tbb::cache_aligned_allocator<unsigned char>>;

/// NanoVDB's name for a grid of values of type T.
template <typename T>
struct NanoBuild {
  using Type = T;
};
template <>
struct NanoBuild<openvdb::Vec3f> {
  using Type = nanovdb::Vec3f;
};

template <class TreeT>
class NanoNodes {
public:
  using T = typename TreeT::ValueType;
  using Build = typename NanoBuild<T>::Type;
  using OpenUpper = typename TreeT::RootNodeType::ChildNodeType;
  using OpenLower = typename OpenUpper::ChildNodeType;
  using OpenLeaf = typename TreeT::LeafNodeType;
  using Leaf = typename nanovdb::NanoLeaf<Build>::DataType;
  using Lower = typename nanovdb::NanoLower<Build>::DataType;
  using Upper = typename nanovdb::NanoUpper<Build>::DataType;
  using Root = typename nanovdb::NanoRoot<Build>::DataType;
  static constexpr bool kIsBool = std::is_same_v<T, bool>;

  /// What is known of the active values of nodes.
  struct Summary {
    nanotools::Stats<Build> values;
    nanovdb::CoordBBox box; ///< empty at first

    void add(const Summary& o) {
      values.add(o.values);
      box.min().minComponent(o.box.min());
      box.max().maxComponent(o.box.max());
    }
    /// An active value of all voxels of a cube.
    void addTile(const openvdb::Coord& origin, const T& value, int dim, std::uint64_t voxels) {
      if constexpr (!kIsBool)
        values.add(nanoValue(value), voxels);
      const nanovdb::Coord low(origin.x(), origin.y(), origin.z());
      box.min().minComponent(low);
      box.max().maxComponent(low + nanovdb::Coord(dim - 1));
    }
  };

  /// `node`: zeros.
  static Summary makeLeaf(const OpenLeaf& from, Leaf& node) {
    Summary sum;
    node.setOrigin(from.origin());
    copyTo(node.mValueMask, &from.getValueMask());
    copyTo(node.mValues, from.buffer().data());
    if (from.getValueMask().isOff())
      return sum;
    reinterpret_cast<nanovdb::NanoLeaf<Build>&>(node).updateBBox();
    sum.box.min() = node.mBBoxMin;
    sum.box.max() =
        node.mBBoxMin + nanovdb::Coord(node.mBBoxDif[0], node.mBBoxDif[1], node.mBBoxDif[2]);
    if constexpr (!kIsBool)
      for (auto it = node.mValueMask.beginOn(); it; ++it)
        sum.values.add(node.mValues[*it]);
    setStatistics(node, sum);
    return sum;
  }

  /// A lower or an upper node; `children`: its entries that are nodes; `sums`: an iterator over
  /// theirs. The entries of children are left to setChildren(). `node`: zeros.
  template <class Open, class Node, class Mask, class Sums>
  static Summary makeInternal(const Open& from, const Mask& children, Sums sums, Node& node) {
    using Child = typename Open::ChildNodeType;
    copyTo(node.mValueMask, &from.getValueMask());
    copyTo(node.mChildMask, &children);
    for (auto it = children.beginOff(); it; ++it) {
      node.mTable[it.pos()].value = nanoValue(from.getTable()[it.pos()].getValue());
    }
    Summary sum;
    for (auto it = from.getValueMask().beginOn(); it; ++it)
      sum.addTile(from.offsetToGlobalCoord(it.pos()), from.getTable()[it.pos()].getValue(),
                  static_cast<int>(Child::DIM), Child::NUM_VOXELS);
    for (auto it = children.beginOn(); it; ++it)
      sum.add(*sums++);
    node.mBBox = sum.box;
    node.mFlags = sum.box.empty() ? 1 : 2; // nothing to render, or something active
    if (!sum.box.empty())
      setStatistics(node, sum);
    return sum;
  }

  /// Puts the distances of children, which lie one behind the other from `first` on, where the node
  /// is at 0.
  template <class Node>
  static void setChildren(Node& node, std::int64_t first, std::size_t childBytes) {
    for (auto it = node.mChildMask.beginOn(); it; ++it) {
      node.mTable[*it].child = first;
      first += static_cast<std::int64_t>(childBytes);
    }
  }

  template <class Node>
  static void setStatistics(Node& node, const Summary& sum) {
    if constexpr (!kIsBool) {
      using Mean = std::decay_t<decltype(node.mAverage)>;
      node.setMin(sum.values.min());
      node.setMax(sum.values.max());
      node.setAvg(static_cast<Mean>(sum.values.avg()));
      node.setDev(static_cast<Mean>(sum.values.std()));
    }
  }

  static Build nanoValue(const T& value) {
    if constexpr (std::is_same_v<T, Build>)
      return value;
    else
      return Build(value[0], value[1], value[2]);
  }

private:
  template <class To>
  static void copyTo(To& to, const void* from) {
    std::memcpy(static_cast<void*>(&to), from, sizeof to);
  }
};

} // namespace tetvdb
