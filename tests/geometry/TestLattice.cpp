// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/Exact.h"
#include "tetvdb/geometry/Lattice.h"

#include <gtest/gtest.h>

namespace {

using namespace tetvdb;

TEST(Lattice, SnapsToTheNearestUnitEvenOnHalves) {
  EXPECT_EQ(snapToLattice(1.0, 0.0, 1.0), 1048576.0);
  EXPECT_EQ(snapToLattice(0.5, 0.0, 1048576.0), 0.0); // half a unit goes to even
  EXPECT_EQ(snapToLattice(1.5, 0.0, 1048576.0), 2.0);
  EXPECT_EQ(snapToLattice(-1.5, 0.0, 1048576.0), -2.0);
  EXPECT_EQ(snapToLattice(7.0, 4.0, 2.0), 1.5 * 1048576.0);
}

TEST(Lattice, VoxelsAroundACoordinate) {
  const double unit = 1048576.0;
  for (int v : {-3, -1, 0, 1, 5}) {
    EXPECT_EQ(ceilVoxel(v * unit), v);
    EXPECT_EQ(floorVoxel(v * unit), v);
    EXPECT_EQ(ceilVoxel(v * unit + 1), v + 1);
    EXPECT_EQ(floorVoxel(v * unit + 1), v);
    EXPECT_EQ(ceilVoxel(v * unit - 1), v);
    EXPECT_EQ(floorVoxel(v * unit - 1), v - 1);
  }
}

TEST(Exact, DividesTowardsMinusAndPlusInfinity) {
  for (int n = -9; n <= 9; ++n) {
    EXPECT_EQ(static_cast<int>(floorDivide(n, 4)), static_cast<int>(std::floor(n / 4.0)));
    EXPECT_EQ(static_cast<int>(ceilDivide(n, 4)), static_cast<int>(std::ceil(n / 4.0)));
  }
}

} // namespace
