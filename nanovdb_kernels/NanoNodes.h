// SPDX-License-Identifier: Apache-2.0
//
// NanoVDB's nodes in the form in which the kernels write them. Nodes above leaves, and leaves of
// floats and int32s, are written as those of a grid of uint32: the values' bits. The layout is the
// same, and in grids of bools and masks a value is the first byte of these bits and the statistics
// are 0.
#pragma once

#include "Team.h"
#include "tetvdb/core/NanoVdb.h"

namespace tetvdb::nano {

using Kind = nanovdb::GridType;

using TreeData = nanovdb::NanoTree<u32>::DataType;
using RootData = nanovdb::NanoRoot<u32>::DataType;
using RootTile = RootData::Tile;
using UpperNode = nanovdb::NanoUpper<u32>::DataType;
using LowerNode = nanovdb::NanoLower<u32>::DataType;
using ValueLeaf = nanovdb::NanoLeaf<u32>::DataType;
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

TETVDB_HD constexpr u64 leafSize(Kind kind) {
  return kind == Kind::Mask      ? sizeof(MaskLeaf)
         : kind == Kind::Boolean ? sizeof(BoolLeaf)
                                 : sizeof(ValueLeaf);
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
