// SPDX-License-Identifier: Apache-2.0
//
// The winding number of triangles on the lattice, summed one by one, and the voxels to judge by it.
#pragma once

#include "SolidAngleOracle.h"
#include "tetvdb/geometry/FillHoles.h"
#include "tetvdb/voxelize/WindingBand.h"

#include <array>
#include <vector>

namespace tetvdb::test {

/// The definition. `voxel`: in index space.
inline double windingOf(const std::vector<FillTriangle>& triangles, const Vec3d& voxel) {
  long double total = 0;
  for (const FillTriangle& t : triangles) {
    const LatticePoint* corners[3] = {&t.a, &t.b, &t.c};
    std::array<std::array<long double, 3>, 3> v;
    for (std::size_t i = 0; i < 3; ++i)
      v[i] = {corners[i]->x - voxel[0] * static_cast<double>(kUnitsPerVoxel),
              corners[i]->y - voxel[1] * static_cast<double>(kUnitsPerVoxel),
              corners[i]->z - voxel[2] * static_cast<double>(kUnitsPerVoxel)};
    total += t.weight * solidAngle(v);
  }
  return static_cast<double>(total / kSphere);
}

/// Calls found(voxel, winding number) for every voxel that the band evaluates.
template <class Found>
void forEvaluated(const WindingBand& band, const Found& found) {
  std::vector<double> values(std::size_t(kSlabRows) * kNodeSize);
  SlabBits flags;
  for (const NodeIndex& index : band.nodes()) {
    const WindingBand::Node node = band.enter(index);
    for (int slab = 0; slab < kSlabsPerNode; ++slab) {
      if (!band.evaluate(node, slab, flags, values))
        continue;
      for (int row = 0; row < kSlabRows; ++row)
        for (int z = 0; z < kNodeSize; ++z)
          if ((flags.rows[row][z >> 6] >> (z & 63) & 1) != 0)
            found(std::array<int, 3>{index[0] * kNodeSize + slab * kLeafSize + row / kNodeSize,
                                     index[1] * kNodeSize + row % kNodeSize,
                                     index[2] * kNodeSize + z},
                  values[std::size_t(row) * kNodeSize + std::size_t(z)]);
    }
  }
}

} // namespace tetvdb::test
