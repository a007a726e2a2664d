// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/BoxBlocks.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

namespace tetvdb {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

// Whole numbers below 2^20 are floats: nothing is rounded, and boxes often just touch.
std::vector<Box> randomBoxes(std::size_t count, unsigned seed, int max, int size) {
  std::mt19937 random(seed);
  std::vector<Box> boxes(count);
  for (Box& box : boxes) {
    const Vec3d p{double(random() % unsigned(max)), double(random() % unsigned(max)),
                  double(random() % unsigned(max))};
    box.add(p);
    box.add(Vec3d{p[0] + double(random() % unsigned(size)),
                  p[1] + double(random() % unsigned(size)),
                  p[2] + double(random() % unsigned(size))});
  }
  return boxes;
}

TEST(BoxBlocks, PairsAreThoseThatMeet) {
  for (const std::size_t count : {0u, 1u, 7u, 8u, 9u, 64u, 65u, 700u}) {
    const std::vector<Box> boxes = randomBoxes(count, unsigned(count), 40, 9);
    const BoxBlocks blocks(boxes.size(), [&](std::size_t i) { return boxes[i]; });
    std::vector<Pair> found, expected;
    for (std::size_t block = 0; block < blocks.blocks(); ++block) {
      std::vector<Pair> part;
      blocks.pairs(block, ~std::size_t(0), part);
      found.insert(found.end(), part.begin(), part.end());
    }
    for (Pair& pair : found)
      if (pair.first > pair.second)
        std::swap(pair.first, pair.second);
    std::sort(found.begin(), found.end());
    for (std::uint32_t i = 0; i < count; ++i)
      for (std::uint32_t k = i + 1; k < count; ++k)
        if (boxes[i].meets(boxes[k]))
          expected.push_back({i, k});
    EXPECT_EQ(found, expected);
  }
}

TEST(BoxBlocks, AboveIsALineUpward) {
  const std::vector<Box> boxes = randomBoxes(500, 3, 30, 7);
  const BoxBlocks blocks(boxes.size(), [&](std::size_t i) { return boxes[i]; });
  std::mt19937 random(9);
  for (int i = 0; i < 300; ++i) {
    const Vec3d at{double(random() % 35), double(random() % 35), double(random() % 35)};
    const std::size_t axis = std::size_t(i) % 3;
    Box line{at, at};
    line.high[axis] = 1e6;
    std::vector<std::uint32_t> found, expected;
    blocks.above(axis, at, [&](std::uint32_t item) {
      found.push_back(item);
      return false;
    });
    std::sort(found.begin(), found.end());
    for (std::uint32_t k = 0; k < boxes.size(); ++k)
      if (boxes[k].meets(line))
        expected.push_back(k);
    EXPECT_EQ(found, expected);
  }
}

} // namespace
} // namespace tetvdb
