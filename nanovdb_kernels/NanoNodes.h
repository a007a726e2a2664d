// SPDX-License-Identifier: Apache-2.0
//
// NanoVDB's nodes in the form in which the kernels write them. Nodes above leaves, and leaves of
// floats and int32s, are written as those of a grid of uint32: the values' bits. The layout is the
// same, and in grids of bools and masks a value is the first byte of these bits and the statistics
// are 0. Grids of vectors have nodes of their own.
#pragma once

#include "Team.h"
#include "tetvdb/core/NanoVdb.h"

namespace tetvdb::nano {

using Kind = nanovdb::GridType;

using Vector = nanovdb::Vec3f;

/// The nodes of grids whose values are V: u32, which are bits, or Vector.
template <typename V>
struct NodesOf {
  using Root = typename nanovdb::NanoRoot<V>::DataType;
  using Upper = typename nanovdb::NanoUpper<V>::DataType;
  using Lower = typename nanovdb::NanoLower<V>::DataType;
  using Leaf = typename nanovdb::NanoLeaf<V>::DataType;
};

using TreeData = nanovdb::NanoTree<u32>::DataType;
using RootData = NodesOf<u32>::Root;
using RootTile = RootData::Tile;
using UpperNode = NodesOf<u32>::Upper;
using LowerNode = NodesOf<u32>::Lower;
using ValueLeaf = NodesOf<u32>::Leaf;
using BoolLeaf = nanovdb::NanoLeaf<bool>::DataType;
using MaskLeaf = nanovdb::NanoLeaf<nanovdb::ValueMask>::DataType; ///< the beginning of all leaves

template <typename T>
constexpr bool kIsWrittenAsU32 = sizeof(nanovdb::NanoRoot<T>) == sizeof(RootData) &&
                                 sizeof(typename nanovdb::NanoRoot<T>::DataType::Tile) ==
                                     sizeof(RootTile) &&
                                 sizeof(nanovdb::NanoUpper<T>) == sizeof(UpperNode) &&
                                 sizeof(nanovdb::NanoLower<T>) == sizeof(LowerNode);
static_assert(kIsWrittenAsU32<float> && kIsWrittenAsU32<i32> && kIsWrittenAsU32<bool> &&
                  kIsWrittenAsU32<nanovdb::ValueMask>,
              "nodes above leaves are the same");
static_assert(sizeof(nanovdb::NanoLeaf<float>) == sizeof(ValueLeaf) &&
                  sizeof(nanovdb::NanoLeaf<i32>) == sizeof(ValueLeaf),
              "leaves of four-byte values are the same");

static_assert(sizeof(NodesOf<Vector>::Root::Tile) == sizeof(RootTile) &&
                  sizeof(nanovdb::NanoTree<Vector>) == sizeof(TreeData),
              "root tiles of vectors are as large as others");

/// In bytes.
struct NodeSizes {
  u64 root, upper, lower, leaf;
};

template <typename V>
TETVDB_HD constexpr NodeSizes sizesOf(u64 leaf) {
  return {sizeof(typename NodesOf<V>::Root), sizeof(typename NodesOf<V>::Upper),
          sizeof(typename NodesOf<V>::Lower), leaf};
}
TETVDB_HD constexpr NodeSizes nodeSizes(Kind kind) {
  return kind == Kind::Vec3f     ? sizesOf<Vector>(sizeof(NodesOf<Vector>::Leaf))
         : kind == Kind::Mask    ? sizesOf<u32>(sizeof(MaskLeaf))
         : kind == Kind::Boolean ? sizesOf<u32>(sizeof(BoolLeaf))
                                 : sizesOf<u32>(sizeof(ValueLeaf));
}

/// A mask's words of 64 bits.
template <typename Mask>
TETVDB_HD u64* wordsOf(Mask& mask) {
  return reinterpret_cast<u64*>(&mask);
}
template <typename Mask>
TETVDB_HD const u64* wordsOf(const Mask& mask) {
  return reinterpret_cast<const u64*>(&mask);
}

/// Statistics of a node's active values, in float and int grids.
struct NodeValues {
  u32 min, max; ///< bits of the value
  float average, deviation;
};

template <typename Node>
TETVDB_HD void setValues(Node& node, const NodeValues& values) {
  node.mMinimum = values.min;
  node.mMaximum = values.max;
  node.mAverage = values.average;
  node.mStdDevi = values.deviation;
}

} // namespace tetvdb::nano
