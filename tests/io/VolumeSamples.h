// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/volume/Volume.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <random>

namespace tetvdb::test {

/// Voxels in several cubes, a fifth of them inactive, and tiles of every level, active and not.
/// `make` turns a number into a value.
template <class TreeT, class Make>
void scatterNodes(TreeT& tree, const Make& make, int voxels, double spread, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> place(0, spread), value(0, 3);
  for (int i = 0; i < voxels; ++i) {
    const int far = static_cast<int>(random() % 3) * 5000 - 5000;
    const openvdb::Coord at(static_cast<int>(place(random)) + far, static_cast<int>(place(random)),
                            static_cast<int>(place(random)) - far);
    if (i % 5 == 0)
      tree.setValueOff(at, make(value(random)));
    else
      tree.setValueOn(at, make(value(random)));
  }
  tree.addTile(1, {2000, 300, -8}, make(2), true);
  tree.addTile(1, {2000, 300, -16}, make(-4), false);
  tree.addTile(2, {-512, 1024, 128}, make(1.5), true);
  tree.addTile(2, {-512, 1024, 256}, make(2.5), false);
  tree.addTile(3, {8192, 0, 0}, make(3), true);
  tree.addTile(3, {-12288, 0, 0}, make(4), false);
}

/// The type, the counts and the ranges of two grids.
inline void expectSameCounts(const GridInfo& a, const GridInfo& b) {
  EXPECT_EQ(a.type, b.type) << b.name;
  EXPECT_EQ(a.activeVoxels, b.activeVoxels) << b.name;
  EXPECT_EQ(a.activeTiles, b.activeTiles) << b.name;
  EXPECT_EQ(a.leaves, b.leaves) << b.name;
  EXPECT_EQ(a.bytes, b.bytes) << b.name;
  EXPECT_EQ(a.boxMin, b.boxMin) << b.name;
  EXPECT_EQ(a.boxMax, b.boxMax) << b.name;
  EXPECT_EQ(a.minValue, b.minValue) << b.name;
  EXPECT_EQ(a.maxValue, b.maxValue) << b.name;
}

} // namespace tetvdb::test
