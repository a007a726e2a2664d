// SPDX-License-Identifier: Apache-2.0
//
// The active voxels, or the values, of a NanoVDB grid as a dense array.
#pragma once

#include "DeviceVoxelizer.h"
#include "NanoNodes.h"

namespace tetvdb::nano {

/// A byte a voxel, 1 where it is active.
struct ActiveBytes {
  u8* to;

  template <typename Accessor>
  TETVDB_HD void operator()(u64 at, const Accessor& accessor, const nanovdb::Coord& voxel,
                            int count) const {
    u32 run = 0;
    if (const auto* leaf = accessor.probeLeaf(voxel))
      run = static_cast<u32>(wordsOf(leaf->valueMask())[voxel[0] & 7] >>
                             (8 * (voxel[1] & 7) + (voxel[2] & 7)));
    else if (accessor.isActive(voxel))
      run = 0xFF;
    for (int k = 0; k < count; ++k)
      to[at + static_cast<u64>(k)] = run >> k & 1;
  }
};

/// The values of a grid of floats.
struct FloatValues {
  float* to;

  template <typename Accessor>
  TETVDB_HD void operator()(u64 at, const Accessor& accessor, const nanovdb::Coord& voxel,
                            int count) const {
    const auto* leaf = accessor.probeLeaf(voxel);
    const float tile = leaf == nullptr ? accessor.getValue(voxel) : 0;
    const u32 first = leaf == nullptr ? 0 : leaf->CoordToOffset(voxel);
    for (int k = 0; k < count; ++k)
      to[at + static_cast<u64>(k)] =
          leaf == nullptr ? tile : leaf->getValue(first + static_cast<u32>(k));
  }
};

/// Writes a dense array [x][y][z] of the range: calls write(at, accessor, voxel, count) for `count`
/// voxels from `voxel` on, at most a row of a leaf, whose first is element `at` of the array.
template <typename Value, typename Backend, typename Write>
void expandRows(Backend& b, const u8* bytes, const VoxelRange& range, const Write& write) {
  if (range.size[0] == 0 || range.size[1] == 0 || range.size[2] == 0)
    return;
  const auto* grid = reinterpret_cast<const nanovdb::NanoGrid<Value>*>(bytes);
  // Rows of leaves that meet the range.
  const i64 first = i64(range.min[2]) >> 3;
  const u64 rows = static_cast<u64>(((i64(range.min[2]) + range.size[2] - 1) >> 3) - first + 1);
  b.forEach(
      u64(range.size[0]) * range.size[1] * rows, TETVDB_KERNEL(u64 i) {
        const u64 column = i / rows;
        const i64 row = (first + static_cast<i64>(i % rows)) * 8, min = range.min[2];
        const i64 begin = row < min ? min : row;
        const i64 end = row + 8 < min + range.size[2] ? row + 8 : min + range.size[2];
        const nanovdb::Coord voxel(range.min[0] + static_cast<i32>(column / range.size[1]),
                                   range.min[1] + static_cast<i32>(column % range.size[1]),
                                   static_cast<i32>(begin));
        write(column * range.size[2] + static_cast<u64>(begin - min), grid->getAccessor(), voxel,
              static_cast<int>(end - begin));
      });
}

/// Bytes 0 and 1 of the range's voxels, [x][y][z].
template <typename Backend>
void expandActive(Backend& b, Kind kind, const u8* bytes, const VoxelRange& range, u8* to) {
  if (kind == Kind::Mask)
    expandRows<nanovdb::ValueMask>(b, bytes, range, ActiveBytes{to});
  else if (kind == Kind::Boolean)
    expandRows<bool>(b, bytes, range, ActiveBytes{to});
  else if (kind == Kind::Float)
    expandRows<float>(b, bytes, range, ActiveBytes{to});
  else
    expandRows<i32>(b, bytes, range, ActiveBytes{to});
}

} // namespace tetvdb::nano
