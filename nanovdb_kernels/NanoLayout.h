// SPDX-License-Identifier: Apache-2.0
//
// Where things lie in a NanoVDB buffer, the same bytes in NanoVDB 32.4 to 32.9, as plain structs
// that need none of NanoVDB's headers; the tests hold them against these.
#pragma once

#include "Team.h"

#include <cstddef>

namespace tetvdb::nano {

/// Kinds of grid that are built, by NanoVDB's number of the type.
enum class Kind : u32 { Float = 1, Int32 = 4, Mask = 8, Bool = 11 };

struct GridHeader {
  u64 magic, checksum;
  u32 version, flags, gridIndex, gridCount;
  u64 gridSize;
  char name[256];
  float mapMatrixF[9], mapInverseF[9], mapTranslationF[3], taperF;
  double mapMatrix[9], mapInverse[9], mapTranslation[3], taper;
  double worldBox[6], voxelSize[3];
  u32 gridClass, gridType;
  i64 blindOffset;
  u32 blindCount, data0;
  u64 data1, data2;
};
static_assert(sizeof(GridHeader) == 672, "NanoVDB's GridData");

struct TreeHeader {
  u64 nodeOffset[4]; // from here: first leaf, lower node, upper node, root
  u32 nodeCount[3], tileCount[3];
  u64 voxelCount;
};
static_assert(sizeof(TreeHeader) == 64, "NanoVDB's TreeData");

/// Statistics as float and int grids have them; bool and mask grids leave them 0 (and theirs would
/// be bytes).
struct NodeValues {
  u32 min, max; // bits of the value
  float average, deviation;
};

struct RootHeader {
  i32 boxMin[3], boxMax[3];
  u32 tableSize;
  u32 values[5]; // background, then NodeValues; for bool and mask the first byte is the background
  u32 padding[4];
};
static_assert(sizeof(RootHeader) == 64, "NanoVDB's RootData");

struct RootTile {
  u64 key;
  i64 child; // from the root; 0: a tile
  u32 state, value;
  u32 padding[2];
};
static_assert(sizeof(RootTile) == 32, "NanoVDB's RootData::Tile");

/// log2 of the children along an axis: 4 or 5.
template <int kLog2>
struct InternalNode {
  static constexpr u32 kChildren = 1u << (3 * kLog2);
  i32 boxMin[3], boxMax[3];
  u64 flags;
  u64 valueMask[kChildren / 64], childMask[kChildren / 64];
  NodeValues values;
  u32 padding[4];
  u64 table[kChildren]; // the value in the first four bytes, or the child's distance from the node
};
using LowerNode = InternalNode<4>;
using UpperNode = InternalNode<5>;
static_assert(sizeof(LowerNode) == 33856 && offsetof(LowerNode, table) == 1088, "128^3");
static_assert(sizeof(UpperNode) == 270400 && offsetof(UpperNode, table) == 8256, "4096^3");

struct LeafHead {
  i32 boxMin[3];
  u8 boxSize[3], flags;
  u64 mask[8];
};
static_assert(sizeof(LeafHead) == 80, "what all leaves begin with");

/// Of a float or an int grid.
struct ValueLeaf {
  LeafHead head;
  NodeValues values;
  u32 table[512];
};
static_assert(sizeof(ValueLeaf) == 2144, "NanoVDB's LeafData<float>");

struct BoolLeaf {
  LeafHead head;
  u64 table[8];
  u64 padding[2];
};
static_assert(sizeof(BoolLeaf) == 160, "NanoVDB's LeafData<bool>");

struct MaskLeaf {
  LeafHead head;
  u64 padding[2];
};
static_assert(sizeof(MaskLeaf) == 96, "NanoVDB's LeafData<ValueMask>");

TETVDB_HD constexpr u64 leafSize(Kind kind) {
  return kind == Kind::Mask   ? sizeof(MaskLeaf)
         : kind == Kind::Bool ? sizeof(BoolLeaf)
                              : sizeof(ValueLeaf);
}

} // namespace tetvdb::nano
