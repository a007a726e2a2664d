// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/MixBits.h"

#include <gtest/gtest.h>

namespace {

using namespace tetvdb;

// The generator's published output for the seed 0.
TEST(MixBits, IsSplitMix64) {
  EXPECT_EQ(hashOfIndex(0), 0xE220A8397B1DCDAFu);
  EXPECT_EQ(hashOfIndex(1), 0x6E789E6AA1B965F4u);
  EXPECT_EQ(hashOfIndex(2), 0x06C45D188009454Fu);
  EXPECT_EQ(hashOfIndex(3), 0xF88BB8A8724C81ECu);
}

TEST(MixBits, PointsThatAreEqualHashAlike) {
  EXPECT_EQ(hashOfPoint({0.0, -0.0, 1}), hashOfPoint({-0.0, 0.0, 1}));
  EXPECT_NE(hashOfPoint({0, 1, 0}), hashOfPoint({1, 0, 0}));
}

} // namespace
