// SPDX-License-Identifier: Apache-2.0
//
// The active voxels of a NanoVDB grid as a dense array.
#pragma once

#include "DeviceVoxelizer.h"
#include "NanoNodes.h"

namespace tetvdb::nano {

/// Writes a byte a voxel, 1 where it is active, [x][y][z], to `to`. Eight voxels of a leaf's row at
/// a time.
template <typename Value, typename Backend>
void expandActive(Backend& b, const u8* bytes, const VoxelRange& range, u8* to) {
  const auto* grid = reinterpret_cast<const nanovdb::NanoGrid<Value>*>(bytes);
  // Rows of leaves that meet the range.
  const i64 first = i64(range.min[2]) >> 3;
  const u64 rows = static_cast<u64>(((i64(range.min[2]) + range.size[2] - 1) >> 3) - first + 1);
  b.forEach(
      u64(range.size[0]) * range.size[1] * rows, TETVDB_KERNEL(u64 i) {
        const u64 column = i / rows;
        const i32 x = range.min[0] + static_cast<i32>(column / range.size[1]),
                  y = range.min[1] + static_cast<i32>(column % range.size[1]),
                  z = static_cast<i32>(first + static_cast<i64>(i % rows)) * 8;
        const auto accessor = grid->getAccessor();
        const auto* leaf = accessor.probeLeaf(nanovdb::Coord(x, y, z));
        u32 run = 0;
        if (leaf != nullptr)
          run = static_cast<u32>(wordsOf(leaf->valueMask())[x & 7] >> (8 * (y & 7))) & 0xFF;
        else if (accessor.isActive(nanovdb::Coord(x, y, z)))
          run = 0xFF;
        u8* out = to + column * range.size[2];
        for (i32 k = 0; k < 8; ++k) {
          const i64 at = i64(z) + k - range.min[2];
          if (at >= 0 && at < i64(range.size[2]))
            out[at] = run >> k & 1;
        }
      });
}

template <typename Backend>
void expandActive(Backend& b, Kind kind, const u8* bytes, const VoxelRange& range, u8* to) {
  if (range.size[0] == 0 || range.size[1] == 0 || range.size[2] == 0)
    return;
  if (kind == Kind::Mask)
    expandActive<nanovdb::ValueMask>(b, bytes, range, to);
  else if (kind == Kind::Boolean)
    expandActive<bool>(b, bytes, range, to);
  else if (kind == Kind::Float)
    expandActive<float>(b, bytes, range, to);
  else
    expandActive<i32>(b, bytes, range, to);
}

} // namespace tetvdb::nano
