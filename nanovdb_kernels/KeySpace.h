// SPDX-License-Identifier: Apache-2.0
//
// Numbers the nodes of all levels in two orders: by columns (x, y, then z: a column's nodes follow
// one another upward), and by the tree (a node's children follow one another as in its table).
#pragma once

#include "Team.h"
#include "tetvdb/core/Error.h"

namespace tetvdb::nano {

/// Leaf coordinates (voxels / 8) within the root tiles that a mesh meets.
struct KeySpace {
  i64 base[3]; ///< leaf coordinate of the first root tile, a multiple of 512
  int bits[3]; ///< 2^bits leaves along the axis, at least 9
  int total() const { return bits[0] + bits[1] + bits[2]; }
};

struct Place {
  u64 x, y, z; // relative to the base
};

/// The root tiles that hold the leaves first .. last.
inline KeySpace spaceAround(const i64 (&first)[3], const i64 (&last)[3]) {
  KeySpace space{};
  for (int k = 0; k < 3; ++k) {
    space.base[k] = first[k] & ~i64(511);
    const u64 leaves = static_cast<u64>(last[k] - space.base[k] + 1);
    space.bits[k] = 9;
    while (u64(1) << space.bits[k] < leaves)
      ++space.bits[k];
  }
  if (space.total() > 63)
    throw Error(Status::Limit, "", "the grid is too wide for the device",
                "use larger voxels or `device=cpu`");
  return space;
}

/// log2 of the leaves along a node: leaf, lower, upper.
TETVDB_HD constexpr int levelShift(int level) {
  return level == 0 ? 0 : level == 1 ? 4 : 9;
}

TETVDB_HD inline u64 columnKey(const KeySpace& s, int level, const Place& p) {
  const int shift = levelShift(level);
  const int z = s.bits[2] - shift, y = s.bits[1] - shift;
  return (p.x << (y + z)) | (p.y << z) | p.z;
}

/// Bits of a column key that say where along the column.
TETVDB_HD inline int heightBits(const KeySpace& s, int level) {
  return s.bits[2] - levelShift(level);
}

TETVDB_HD inline Place placeOfColumnKey(const KeySpace& s, int level, u64 key) {
  const int shift = levelShift(level);
  const int z = s.bits[2] - shift, y = s.bits[1] - shift;
  return {key >> (y + z), (key >> z) & ((u64(1) << y) - 1), key & ((u64(1) << z) - 1)};
}

/// A node's place in its parent's table.
TETVDB_HD inline u64 tableIndex(const Place& p, int log2) {
  const u64 m = (u64(1) << log2) - 1;
  return (((p.x & m) << log2 | (p.y & m)) << log2) | (p.z & m);
}

TETVDB_HD inline u64 treeKey(const KeySpace& s, int level, const Place& p) {
  const int up = 9 - levelShift(level);
  u64 key = columnKey(s, 2, {p.x >> up, p.y >> up, p.z >> up});
  if (level < 2) {
    const int toLower = level == 0 ? 4 : 0;
    key = key << 15 | tableIndex({p.x >> toLower, p.y >> toLower, p.z >> toLower}, 5);
  }
  return level == 0 ? key << 12 | tableIndex(p, 4) : key;
}

TETVDB_HD inline Place childPlace(const Place& parent, int log2, u64 index) {
  const u64 m = (u64(1) << log2) - 1;
  return {parent.x << log2 | (index >> (2 * log2) & m), parent.y << log2 | (index >> log2 & m),
          parent.z << log2 | (index & m)};
}

TETVDB_HD inline Place placeOfTreeKey(const KeySpace& s, int level, u64 key) {
  Place p = placeOfColumnKey(s, 2, key >> (level == 0 ? 27 : level == 1 ? 15 : 0));
  if (level < 2)
    p = childPlace(p, 5, key >> (level == 0 ? 12 : 0));
  return level == 0 ? childPlace(p, 4, key) : p;
}

/// The columns of root tiles (x, then y) begin .. end - 1, which one of several devices builds.
/// Nothing is carried from one such column to another.
struct RootShare {
  u64 begin = 0, end = ~u64(0);

  /// Number of the column that a node is in.
  TETVDB_HD static u64 columnOf(const KeySpace& s, int level, const Place& p) {
    const int up = 9 - levelShift(level);
    return (p.x >> up) << (s.bits[1] - 9) | (p.y >> up);
  }
  TETVDB_HD bool has(const KeySpace& s, int level, const Place& p) const {
    const u64 column = columnOf(s, level, p);
    return begin <= column && column < end;
  }
};

/// First voxel of a node.
TETVDB_HD inline void originOf(const KeySpace& s, int level, const Place& p, i32 (&origin)[3]) {
  const int shift = levelShift(level);
  origin[0] = static_cast<i32>((s.base[0] + static_cast<i64>(p.x << shift)) * 8);
  origin[1] = static_cast<i32>((s.base[1] + static_cast<i64>(p.y << shift)) * 8);
  origin[2] = static_cast<i32>((s.base[2] + static_cast<i64>(p.z << shift)) * 8);
}

} // namespace tetvdb::nano
