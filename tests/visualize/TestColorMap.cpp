// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/visualize/ColorMap.h"
#include "tetvdb/visualize/Srgb.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

void expectSrgb(const ColorMap& map, double t, int red, int green, int blue, int error) {
  const Rgb rgb = map(t);
  EXPECT_NEAR(srgbByte(rgb[0]), red, error) << t;
  EXPECT_NEAR(srgbByte(rgb[1]), green, error) << t;
  EXPECT_NEAR(srgbByte(rgb[2]), blue, error) << t;
}

// As published: the ends, and values between the stored ones.
TEST(ColorMap, PublishedValues) {
  expectSrgb(ColorMap::named("viridis"), 0, 0x44, 0x01, 0x54, 0);
  expectSrgb(ColorMap::named("viridis"), 1, 0xFD, 0xE7, 0x25, 0);
  expectSrgb(ColorMap::named("viridis"), 17 / 255.0, 72, 26, 108, 1);
  expectSrgb(ColorMap::named("viridis"), 128 / 255.0, 33, 144, 140, 1);
  expectSrgb(ColorMap::named("magma"), 1 / 255.0, 1, 0, 5, 2);
  expectSrgb(ColorMap::named("inferno"), 254 / 255.0, 250, 253, 161, 2);
  expectSrgb(ColorMap::named("plasma"), 1 / 255.0, 16, 7, 136, 2);
  expectSrgb(ColorMap::named("cividis"), 1, 254, 232, 56, 0);
  expectSrgb(ColorMap::named("turbo"), 0, 48, 18, 59, 0);
  expectSrgb(ColorMap::named("turbo"), 128 / 255.0, 164, 252, 60, 2);
  expectSrgb(ColorMap::named("coolwarm"), 0, 59, 76, 192, 0);
  expectSrgb(ColorMap::named("coolwarm"), 0.5, 221, 221, 221, 1);
  expectSrgb(ColorMap::named("coolwarm"), 1, 180, 4, 38, 0);
  expectSrgb(ColorMap::named("grey"), 0.5, 128, 128, 128, 1);
}

TEST(ColorMap, OutsideAndBackward) {
  const ColorMap& map = ColorMap::named("magma");
  EXPECT_EQ(map(-3), map(0));
  EXPECT_EQ(map(INFINITY), map(1));
  EXPECT_EQ(map(NAN), colorOfNothing());
  EXPECT_EQ(ColorMap::named("magma_r")(0.25), map(0.75));
  EXPECT_THROW(ColorMap::named("jet"), Error);
  for (const std::string& name : ColorMap::names())
    EXPECT_NO_THROW(ColorMap::named(name + "_r"));
}

TEST(ColorMap, Ticks) {
  ColorScale scale;
  scale.low = -0.3;
  scale.high = 1.7;
  EXPECT_EQ(ticks(scale, 5).size(), 4U); // 0, 0.5, 1, 1.5
  EXPECT_EQ(ticks(scale, 5)[0], 0);
  EXPECT_FALSE(std::signbit(ticks(scale, 5)[0]));
  EXPECT_DOUBLE_EQ(ticks(scale, 5)[3], 1.5);
  scale = {nullptr, 3, 300, true, "", {}};
  const std::vector<double> logarithmic = ticks(scale, 6);
  for (const double tick : logarithmic)
    EXPECT_TRUE(tick >= 3 && tick <= 300);
  EXPECT_NE(std::find(logarithmic.begin(), logarithmic.end(), 10), logarithmic.end());
  EXPECT_NE(std::find(logarithmic.begin(), logarithmic.end(), 100), logarithmic.end());
  scale = {nullptr, 5, 5, false, "", {}};
  EXPECT_EQ(ticks(scale, 6), std::vector<double>{5});
  for (const double size : {1e-300, 1e-7, 1.0, 12345.0, 1e300}) {
    scale = {nullptr, -size, size, false, "", {}};
    const std::size_t count = ticks(scale, 6).size();
    EXPECT_TRUE(count >= 3 && count <= 9) << size << ": " << count;
  }
}

TEST(ColorMap, Scale) {
  ColorScale scale{&ColorMap::named("viridis"), 3, 300, true, "", {}};
  EXPECT_NEAR(scale.position(30), 0.5, 1e-12);
  EXPECT_EQ(scale(30), ColorMap::named("viridis")(0.5));
  EXPECT_EQ(scale(0), ColorMap::named("viridis")(0));
  scale.map = nullptr;
  EXPECT_EQ(scale(2), colorOfKind(2));
  for (std::size_t kind = 0; kind < 30; ++kind)
    EXPECT_NE(colorOfKind(kind), colorOfKind(kind + 1));
}

} // namespace
} // namespace tetvdb
