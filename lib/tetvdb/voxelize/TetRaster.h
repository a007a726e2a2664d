// SPDX-License-Identifier: Apache-2.0
//
// Computes exactly the voxels of a slab that tets own.
#pragma once

#include "tetvdb/geometry/TetBox.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// First voxel of a slab.
struct SlabOrigin {
  std::int64_t x, y, z;
};

/// Tets of negative orientation, taken as reversed, and flat ones, left out.
struct OrientationCounts {
  std::uint64_t flipped = 0, dropped = 0;

  void count(int sign) {
    flipped += sign < 0;
    dropped += sign == 0;
  }
  void add(const OrientationCounts& o) {
    flipped += o.flipped;
    dropped += o.dropped;
  }
};

TetBox voxelBox(const SnappedMesh& mesh, std::size_t tet);

/// Sets the bits of all voxels owned by any of `count` tets. Along a row, each face plane bounds
/// the voxels inside from below or from above; the bounds are computed in doubles with a proven
/// error and, where that leaves a doubt (a tie above all), in 128-bit integers. `counts` receives
/// the tets whose box begins in this slab, so that each is counted once; not those whose box
/// spansNodes().
void rasterizeTets(const SnappedMesh& mesh, const std::uint32_t* tets, std::size_t count,
                   const SlabOrigin& slab, SlabBits& bits, OrientationCounts& counts);

/// The same, and writes the owner of every newly set voxel to `owners`
/// ([(x * 128 + y) * 128 + z]): of overlapping tets the one that comes first in `tets`.
void rasterizeOwners(const SnappedMesh& mesh, const std::uint32_t* tets, std::size_t count,
                     const SlabOrigin& slab, SlabBits& bits, std::uint32_t* owners,
                     OrientationCounts& counts);

/// The position of a tet relative to a box of voxel centres (inclusive, voxels). Conservative:
/// Inside and Outside are certain.
enum class Cover : std::uint8_t { Outside, Partial, Inside };
Cover classifyBox(const SnappedMesh& mesh, std::size_t tet, const TetBox& box);

} // namespace tetvdb
