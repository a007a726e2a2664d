// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/ErrorDiffusion.h"

#include <algorithm>
#include <cstdlib>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace tetvdb {
namespace {

constexpr int kColumns = 90, kRows = 70;
using Image = std::vector<int>;

Layer layerOf(const Image& image) {
  Layer layer;
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x)
      layer.add(y, x, x + 1, static_cast<std::uint8_t>(image[std::size_t(y * kColumns + x)]));
  return layer;
}

Image imageOf(const Layer& layer) {
  Image image(kColumns * kRows, 0);
  for (std::size_t i = 0; i < layer.rows.size(); ++i) {
    const auto [begin, end] = layer.runsOf(i);
    for (const PixelRun* run = begin; run != end; ++run)
      for (int x = run->begin; x < run->end; ++x)
        image[std::size_t(layer.rows[i].y * kColumns + x)] = run->value;
  }
  return image;
}

int sumOf(const Image& image) {
  int sum = 0;
  for (const int value : image)
    sum += value;
  return sum;
}

TEST(ErrorDiffusion, KeepsTheSumAndWhatIsBlackOrWhite) {
  std::mt19937 random(2);
  for (const int levels : {2, 4, 16, 255}) {
    for (int i = 0; i < 20; ++i) {
      Image image(kColumns * kRows, 0);
      for (int& value : image) {
        const unsigned kind = random() % 4;
        value = kind == 0 ? 0 : kind == 1 ? 255 : int(random() % 256);
      }
      if (i % 2 == 0) // rows without runs
        std::fill(image.begin() + kColumns * 20, image.begin() + kColumns * 23, 0);
      Layer layer = layerOf(image);
      diffuseErrors(layer, kColumns, levels);
      const Image found = imageOf(layer);
      for (std::size_t k = 0; k < image.size(); ++k) {
        if (image[k] == 0 || image[k] == 255) {
          ASSERT_EQ(found[k], image[k]);
        }
        const int level = (found[k] * (levels - 1) + 127) / 255;
        ASSERT_EQ(found[k], (2 * 255 * level + levels - 1) / (2 * (levels - 1)));
      }
      EXPECT_LE(std::abs(sumOf(found) - sumOf(image)), 255 / (levels - 1) + 1);
    }
  }
}

// A grey plane becomes as many white pixels, everywhere in it.
TEST(ErrorDiffusion, IsEvenlySpread) {
  const Image image(kColumns * kRows, 64);
  Layer layer = layerOf(image);
  diffuseErrors(layer, kColumns, 2);
  const Image found = imageOf(layer);
  for (int y = 10; y + 20 <= kRows; y += 10)
    for (int x = 10; x + 20 <= kColumns; x += 10) {
      int white = 0;
      for (int i = 0; i < 400; ++i)
        white += found[std::size_t((y + i / 20) * kColumns + x + i % 20)] == 255;
      EXPECT_NEAR(white, 400 * 64 / 255.0, 8);
    }
}

} // namespace
} // namespace tetvdb
