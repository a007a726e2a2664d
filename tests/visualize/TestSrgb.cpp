// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/Srgb.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

// Values worked out by hand from IEC 61966-2-1.
TEST(Srgb, KnownValues) {
  EXPECT_FLOAT_EQ(srgbOfLinear(0), 0);
  EXPECT_FLOAT_EQ(srgbOfLinear(1), 1);
  EXPECT_NEAR(srgbOfLinear(0.5F), 0.7353569F, 1e-6);
  EXPECT_NEAR(srgbOfLinear(0.18F), 0.4613561F, 1e-6);
  EXPECT_NEAR(srgbOfLinear(0.002F), 0.02584F, 1e-6);
  EXPECT_NEAR(linearOfSrgb(0.5F), 0.2140411F, 1e-6);
  EXPECT_NEAR(linearOfSrgb(0.02F), 0.02F / 12.92F, 1e-8);
}

TEST(Srgb, TheTwoPartsMeet) {
  EXPECT_NEAR(srgbOfLinear(0.0031307F), srgbOfLinear(0.0031309F), 1e-5);
  EXPECT_NEAR(linearOfSrgb(0.04044F), linearOfSrgb(0.04046F), 1e-5);
}

TEST(Srgb, BytesRoundTrip) {
  for (int byte = 0; byte < 256; ++byte)
    EXPECT_EQ(srgbByte(linearOfSrgb(static_cast<float>(byte) / 255)), byte);
}

TEST(Srgb, BytesAreNearest) {
  EXPECT_EQ(srgbByte(0.5F), 188);
  EXPECT_EQ(srgbByte(0.18F), 118);
  EXPECT_EQ(srgbByte(-1), 0);
  EXPECT_EQ(srgbByte(7), 255);
  EXPECT_EQ(srgbByte(NAN), 0);
}

TEST(Srgb, Hex) {
  const Rgb rgb = rgbOfHex(0xFF8000);
  EXPECT_FLOAT_EQ(rgb[0], 1);
  EXPECT_NEAR(rgb[1], 0.2158605F, 1e-6);
  EXPECT_FLOAT_EQ(rgb[2], 0);
}

} // namespace
} // namespace tetvdb
