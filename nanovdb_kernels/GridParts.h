// SPDX-License-Identifier: Apache-2.0
//
// Types for writing a grid: the places of its nodes, and their numbers.
#pragma once

#include "GridValues.h"

#include <cstring>
#include <string>

namespace tetvdb::nano {

/// The head of a grid, but for what its nodes decide. `voxelSize`, `origin`: world units, three
/// numbers each.
inline nanovdb::GridData gridHeader(Kind kind, nanovdb::GridClass gridClass,
                                    const std::string& name, const double* voxelSize,
                                    const double* origin) {
  nanovdb::GridData h{};
  h.mMagic = 0x304244566F6E614Eull;        // "NanoVDB0"
  h.mVersion = nanovdb::Version(32, 4, 2); // the oldest with this layout, so that all read it
  checksumOf(h) = 0;
  flagsOf(h) = u32(nanovdb::GridFlags::IsBreadthFirst);
  if (kind == Kind::Float || kind == Kind::Int32 || kind == Kind::Vec3f)
    flagsOf(h) |= u32(nanovdb::GridFlags::HasMinMax) | u32(nanovdb::GridFlags::HasAverage) |
                  u32(nanovdb::GridFlags::HasStdDeviation);
  h.mGridCount = 1;
  std::memcpy(h.mGridName, name.data(), name.size());
  double scale[3][3] = {}, inverse[3][3] = {};
  for (int k = 0; k < 3; ++k) {
    scale[k][k] = voxelSize[k];
    inverse[k][k] = 1.0 / voxelSize[k];
    h.mVoxelSize[k] = voxelSize[k];
  }
  h.mMap.set(scale, inverse, origin, 1);
  h.mGridClass = gridClass;
  h.mGridType = kind;
  return h;
}

/// The places of the nodes, in bytes. For one of several shares of a grid: the places in the whole
/// grid's buffer, and in the share's own memory.
struct BufferLayout {
  u64 root, upper, lower, leaf, size;
  u64 upperHere, lowerHere, leafHere, sizeHere;
  u64 rootTiles, uppers, lowers, leaves;
};

/// The number of nodes of each kind.
struct NodeCounts {
  u64 rootTiles = 0, uppers = 0, lowers = 0, leaves = 0; ///< rootTiles: upper nodes included
};

/// The layout of a grid of `all` nodes for the share of `own` that follow `before`.
inline BufferLayout layoutOf(Kind kind, const NodeCounts& all, const NodeCounts& before,
                             const NodeCounts& own) {
  const NodeSizes sizes = nodeSizes(kind);
  BufferLayout l;
  l.root = sizeof(nanovdb::GridData) + sizeof(TreeData);
  const u64 uppers = l.root + sizes.root + all.rootTiles * sizeof(RootTile);
  const u64 lowers = uppers + all.uppers * sizes.upper;
  const u64 leaves = lowers + all.lowers * sizes.lower;
  l.size = leaves + all.leaves * sizes.leaf;
  l.upper = uppers + before.uppers * sizes.upper;
  l.lower = lowers + before.lowers * sizes.lower;
  l.leaf = leaves + before.leaves * sizes.leaf;
  l.upperHere = 0;
  l.lowerHere = own.uppers * sizes.upper;
  l.leafHere = l.lowerHere + own.lowers * sizes.lower;
  l.sizeHere = l.leafHere + own.leaves * sizes.leaf;
  l.rootTiles = own.rootTiles;
  l.uppers = own.uppers;
  l.lowers = own.lowers;
  l.leaves = own.leaves;
  return l;
}

/// The layout of a grid with one share, whose memory is the buffer.
inline BufferLayout layoutOf(Kind kind, const NodeCounts& all) {
  BufferLayout l = layoutOf(kind, all, {}, all);
  l.upperHere = l.upper;
  l.lowerHere = l.lower;
  l.leafHere = l.leaf;
  l.sizeHere = l.size;
  return l;
}

/// A tile, a node or nothing at the root.
struct RootEntry {
  u64 key;   ///< tree key
  u64 upper; ///< upper nodes before it
  u64 rank;  ///< root tiles before it
  i32 value; ///< of a tile, as bits; where values vary
  u32 state; ///< as in BuildLevels.h
};

constexpr int kParts = 32; // of sums of doubles, so that their order is fixed

/// The sum of the parts that the team shares; called by one member.
template <typename Shared>
TETVDB_HD Moments sumParts(Shared& s) {
  Moments sum{0, 0, 0};
  for (int p = 0; p < kParts; ++p)
    addMoments(sum, s.part[p]);
  return sum;
}

template <int kLog2, typename V>
struct WriteShared {
  // Upper nodes are few and their tables large.
  static constexpr int kThreads = kLog2 == 5 ? 1024 : 256, kOccupancy = kLog2 == 5 ? 32 : 16;
  static constexpr int kWords = (1 << (3 * kLog2)) / 64;
  u64 child[kWords], tile[kWords];
  u32 before[kWords], spare[kWords]; // children before each word's
  i32 low[3], high[3];
  TeamExtremes<V> extremes;
  u32 tiles, low32; // low32: voxels, where they fit; 64-bit atomics in shared memory are slow
  u64 voxels;
  Moments part[kParts];
};

/// Resets the memory that the team shares to an empty box and no values; called by one member.
template <typename Shared>
TETVDB_HD inline void clearBounds(Shared& s) {
  for (int a = 0; a < 3; ++a) {
    s.low[a] = 0x7FFFFFFF;
    s.high[a] = -0x7FFFFFFF - 1;
  }
  s.extremes.clear();
}

/// The first 16 bytes of a leaf: box of the active voxels, and the flag that there are some.
TETVDB_HD inline void leafBox(const u64* mask, const i32 (&origin)[3], MaskLeaf& leaf) {
  u64 any = 0;
  int xLow = 8, xHigh = 0;
  for (int x = 0; x < 8; ++x)
    if (mask[x] != 0) {
      any |= mask[x];
      xLow = x < xLow ? x : xLow;
      xHigh = x;
    }
  u32 z = 0;
  for (int y = 0; y < 8; ++y)
    z |= static_cast<u32>(any >> (8 * y)) & 0xFF;
  const int yLow = lowestBit(any) >> 3, yHigh = highestBit(any) >> 3;
  const int zLow = lowestBit(z), zHigh = highestBit(z);
  leaf.mBBoxMin[0] = origin[0] + xLow;
  leaf.mBBoxMin[1] = origin[1] + yLow;
  leaf.mBBoxMin[2] = origin[2] + zLow;
  leaf.mBBoxDif[0] = static_cast<u8>(xHigh - xLow);
  leaf.mBBoxDif[1] = static_cast<u8>(yHigh - yLow);
  leaf.mBBoxDif[2] = static_cast<u8>(zHigh - zLow);
  leaf.mFlags = 2;
}

TETVDB_HD inline u64 countVoxels(const u64* mask) {
  u64 count = 0;
  for (int k = 0; k < 8; ++k)
    count += static_cast<u64>(bitCount(mask[k]));
  return count;
}

struct NoShared {
  static constexpr int kThreads = 32, kOccupancy = 32;
};

template <typename V>
struct HeadShared {
  static constexpr int kThreads = 32, kOccupancy = 4;
  i32 low[3], high[3];
  TeamExtremes<V> extremes;
  u64 voxels;
  u32 crc[kParts], crcStart;
  Moments part[kParts];
};

/// The input of the nodes of a level, and the data of them that the level above needs.
struct LevelNodes {
  const u64* index = nullptr;    ///< by place in tree order: number of the node; null: its place
  const u32* nodeSlot = nullptr; ///< by number
  const u64* key = nullptr;      ///< by number: tree key
  u64* voxels = nullptr;         ///< by number: active voxels
  Moments* moments = nullptr;    ///< by number; where values differ
};

/// The input of a grid's head.
struct RootParts {
  const RootEntry* entries; ///< in tree order
  u64 count;
  const u64* voxels;      ///< of upper nodes
  const Moments* moments; ///< of upper nodes; where values differ
  const u64* totals;      ///< [1], [2]: tiles in lower and upper nodes
};

} // namespace tetvdb::nano
