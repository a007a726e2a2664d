// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/ClosestName.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

const std::vector<std::string> kNames = {"voxelize", "tetrahedralize", "info",  "compare",
                                         "repair",   "render",         "check", "report"};

TEST(ClosestName, OneMistake) {
  EXPECT_EQ(closestName("voxelise", kNames), "voxelize");  // replaced
  EXPECT_EQ(closestName("voxlize", kNames), "voxelize");   // left out
  EXPECT_EQ(closestName("voxellize", kNames), "voxelize"); // inserted
  EXPECT_EQ(closestName("voexlize", kNames), "voxelize");  // exchanged
  EXPECT_EQ(closestName("inof", kNames), "info");          // exchanged: one mistake, not two
  EXPECT_EQ(closestName("VOXELIZE", kNames), "voxelize");
}

TEST(ClosestName, TheNearerOne) {
  EXPECT_EQ(closestName("repor", kNames), "report");
  EXPECT_EQ(closestName("repai", kNames), "repair");
  EXPECT_EQ(closestName("bb", {"ab", "bc"}), ""); // half of it is wrong
  EXPECT_EQ(closestName("abd", {"abc", "abe"}), "abc");
}

TEST(ClosestName, Beginnings) {
  EXPECT_EQ(closestName("tetra", kNames), "tetrahedralize");
  EXPECT_EQ(closestName("Temperature_K", {"pressure", "temperature"}), "temperature");
  EXPECT_EQ(closestName("te", kNames), "");
}

TEST(ClosestName, NoneWhereNoneIsNear) {
  EXPECT_EQ(closestName("banana", kNames), "");
  EXPECT_EQ(closestName("", kNames), "");
  EXPECT_EQ(closestName("info", {}), "");
  EXPECT_EQ(closestName("info", {""}), "");
  EXPECT_EQ(suggestName("inffo", kNames, ""), "did you mean 'info'?");
  EXPECT_EQ(suggestName("inffo", kNames, "there is one"), "did you mean 'info'? there is one");
  EXPECT_EQ(suggestName("banana", kNames, "there is one"), "there is one");
}

} // namespace
} // namespace tetvdb
