// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/Legend.h"
#include "tetvdb/visualize/Text.h"

#include <gtest/gtest.h>
#include <set>

namespace tetvdb {
namespace {

const Pixel kPaper = {1, 1, 1, 1}, kInk = {0, 0, 0, 1};

TEST(Legend, TicksShowTheColoursOfTheirNumbers) {
  for (const bool logarithmic : {false, true}) {
    const ColorScale scale{&ColorMap::named("turbo"), 2, 90, logarithmic, "mass", {}};
    Image image(640, 480, kPaper);
    const LegendPlaces places = drawLegend(image, scale, kInk);
    ASSERT_GE(places.ticks.size(), 3U);
    const int midpoint = (places.barLeft + places.barRight) / 2;
    for (std::size_t i = 0; i < places.ticks.size(); ++i) {
      const int row = places.tickRows[i];
      ASSERT_TRUE(row >= places.barTop && row < places.barBottom);
      const Rgb wanted = scale(places.ticks[i]);
      const Pixel found = image.at(midpoint, row);
      // Half a row is the most that a tick is off.
      const double step = 0.5 / (places.barBottom - places.barTop - 1);
      const Rgb low = (*scale.map)(scale.position(places.ticks[i]) - step);
      const Rgb high = (*scale.map)(scale.position(places.ticks[i]) + step);
      const float allowed = std::abs(low[0] - high[0]) + std::abs(low[1] - high[1]) +
                            std::abs(low[2] - high[2]) + 1e-6F;
      EXPECT_NEAR(found.red, wanted[0], allowed);
      EXPECT_NEAR(found.green, wanted[1], allowed);
      EXPECT_NEAR(found.blue, wanted[2], allowed);
      EXPECT_EQ(image.at(places.barRight, row), kInk);
    }
    EXPECT_EQ(image.at(midpoint, places.barTop), opaque((*scale.map)(1)));
    EXPECT_EQ(image.at(midpoint, places.barBottom - 1), opaque((*scale.map)(0)));
  }
}

TEST(Legend, StaysWithinItsWidth) {
  const ColorScale scale{&ColorMap::named("grey"), 0, 1, false, "a title that is rather long", {}};
  Image image(640, 480, kPaper);
  drawLegend(image, scale, kInk);
  for (int y = 0; y < 480; ++y)
    for (int x = 0; x < 640 - legendWidth(scale, 480); ++x)
      ASSERT_EQ(image.at(x, y), kPaper);
  for (int y = 0; y < 480; ++y)
    ASSERT_EQ(image.at(639, y), kPaper);
}

TEST(Legend, Kinds) {
  ColorScale scale;
  scale.kinds = {"bone", "skin", "air"};
  Image image(300, 200, kPaper);
  const LegendPlaces places = drawLegend(image, scale, kInk);
  std::set<float> reds;
  for (int y = 0; y < 200; ++y)
    reds.insert(image.at(places.barLeft + 1, y).red);
  for (std::size_t kind = 0; kind < 3; ++kind)
    EXPECT_EQ(reds.count(colorOfKind(kind)[0]), 1U);
  // More than there is room for: no crash, and the last line tells.
  scale.kinds.assign(5000, "x");
  drawLegend(image, scale, kInk);
}

TEST(Text, LettersAreApartAndWithinTheirWidth) {
  std::set<std::vector<float>> shapes;
  for (char letter = ' '; letter <= '~'; ++letter) {
    const std::string text(1, letter);
    Image image(textWidth(text, 2) + 4, textHeight(2) + 4, kPaper);
    drawText(image, 2, 2, text, kInk, 2);
    std::vector<float> shape;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const bool frame = x < 2 || y < 2 || x >= image.width - 2 || y >= image.height - 2;
        if (frame) {
          EXPECT_EQ(image.at(x, y), kPaper) << letter;
        }
        shape.push_back(image.at(x, y).red);
      }
    EXPECT_TRUE(shapes.insert(shape).second) << letter << " looks like another letter";
  }
}

TEST(Text, OtherBytes) {
  Image a(100, 20, kPaper), b(100, 20, kPaper);
  drawText(a, 0, 0, "b\xC3\xBC\n", kInk, 1);
  drawText(b, 0, 0, "b??", kInk, 1);
  EXPECT_TRUE(a.pixels == b.pixels);
}

TEST(Text, Shortened) {
  EXPECT_EQ(shortened("bunny.stl", 1000, 1), "bunny.stl");
  const std::string name = shortened("a_very_long_name_of_a_file.stl", 60, 1);
  EXPECT_LE(textWidth(name, 1), 60);
  EXPECT_GE(textWidth(name, 1), 50);
  EXPECT_EQ(name.substr(name.size() - 4), ".stl");
}

TEST(Text, Ink) {
  EXPECT_LT(inkOn({1, 1, 1, 1}).red, 0.1F);
  EXPECT_GT(inkOn({0, 0, 0, 1}).red, 0.8F);
  EXPECT_LT(inkOn({0, 0, 0, 0}).red, 0.1F); // on paper
}

} // namespace
} // namespace tetvdb
