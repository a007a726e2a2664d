// SPDX-License-Identifier: Apache-2.0
//
// What the writing of a grid is made of: where its nodes lie, their numbers, sums over their
// values.
#pragma once

#include "NanoLayout.h"

namespace tetvdb::nano {

/// Values of the grid as bits.
struct GridValues {
  u32 inside, background;
};

/// Sums over a node's active values, for int grids.
struct Moments {
  double count, mean, squares; ///< squares: of the distances from the mean
};

/// Chan, Golub and LeVeque's update; in a fixed order the result is fixed.
TETVDB_HD inline void addMoments(Moments& a, const Moments& b) {
  if (b.count == 0)
    return;
  const double count = a.count + b.count, distance = b.mean - a.mean;
  a.squares = a.squares + b.squares + distance * distance * (a.count * b.count / count);
  a.mean = a.mean + distance * (b.count / count);
  a.count = count;
}

/// Where the nodes of a buffer begin, bytes.
struct BufferLayout {
  u64 root, upper, lower, leaf, size;
  u64 rootTiles, uppers, lowers, leaves;
  Kind kind;
};

constexpr int kParts = 32; // of sums of doubles, so that their order is fixed

template <int kLog2>
struct WriteShared {
  static constexpr int kThreads = 256, kOccupancy = 16;
  static constexpr int kWords = (1 << (3 * kLog2)) / 64;
  u64 child[kWords], tile[kWords];
  u32 before[kWords];
  i32 low[3], high[3];
  i32 minValue, maxValue;
  u32 tiles, low32; // low32: voxels, where they fit; 64-bit atomics in shared memory are slow
  u64 voxels;
  Moments part[kParts];
};

struct NoShared {
  static constexpr int kThreads = 32, kOccupancy = 32;
};

struct HeadShared {
  static constexpr int kThreads = 32, kOccupancy = 4;
  i32 low[3], high[3];
  i32 minValue, maxValue;
  u64 voxels;
  u32 crc[kParts];
  Moments part[kParts];
};

/// What the nodes of a level are made from, and what the level above needs to know of them.
struct LevelNodes {
  const u64* index = nullptr;    ///< by place in tree order: number of the node
  const u32* nodeSlot = nullptr; ///< by number
  const u64* key = nullptr;      ///< by number: tree key
  u64* voxels = nullptr;         ///< by number: active voxels
  Moments* moments = nullptr;    ///< by number; int grids
};

} // namespace tetvdb::nano
