// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/SequenceGrids.h"

#include <gtest/gtest.h>

namespace {

using namespace tetvdb;

GridInfo grid(const std::string& name, std::uint64_t voxels, double min, double max, int at) {
  GridInfo info;
  info.name = name;
  info.activeVoxels = voxels;
  info.minValue = min;
  info.maxValue = max;
  if (voxels > 0)
    info.boxMin = info.boxMax = Vec3i{at, -at, 0};
  return info;
}

TEST(SequenceGrids, RangesBoxesAndFramesOfTheExtremes) {
  const std::vector<SequenceGrid> all =
      gridsOfSequence({{grid("a", 0, 0, 0, 0), grid("b", 1, 5, 6, 1)},
                       {}, // nothing is known of it
                       {grid("a", 3, 1, 2, 4), grid("b", 2, 4, 5.5, -2)},
                       {grid("a", 1, 2, 9, 6), grid("c", 0, 0, 0, 0)}});
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].all.name, "a");
  EXPECT_EQ(all[0].all.activeVoxels, 4u);
  EXPECT_EQ(all[0].all.minValue, 1);
  EXPECT_EQ(all[0].all.maxValue, 9);
  EXPECT_EQ(all[0].minFrame, 2u);
  EXPECT_EQ(all[0].maxFrame, 3u);
  EXPECT_EQ(all[0].emptyFrames, std::vector<std::size_t>{0});
  EXPECT_EQ(all[0].all.boxMin, (Vec3i{4, -6, 0}));
  EXPECT_EQ(all[0].all.boxMax, (Vec3i{6, -4, 0}));
  EXPECT_EQ(all[1].all.minValue, 4);
  EXPECT_EQ(all[1].minFrame, 2u);
  EXPECT_EQ(all[1].maxFrame, 0u);
  EXPECT_EQ(all[2].all.activeVoxels, 0u);
  EXPECT_EQ(all[2].emptyFrames, std::vector<std::size_t>{3});
}

} // namespace
