// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/geometry/BoxTree.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

Box randomBox(meshes::Random& random, double size) {
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::floor(random.between(0, 20));
    box.high[axis] = box.low[axis] + std::floor(random.between(0, size));
  }
  return box;
}

TEST(BoxTree, FindsWhatATestOfAllFinds) {
  meshes::Random random(1);
  for (const std::size_t count : {1u, 4u, 5u, 100u, 20000u}) {
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < count; ++i)
      boxes.push_back(randomBox(random, i % 7 == 0 ? 15 : 3));
    const BoxTree tree(boxes);
    for (int round = 0; round < 20; ++round) {
      const Box query = randomBox(random, 3);
      for (const bool containing : {false, true}) {
        const auto enter = [&](const Box& box) {
          return containing ? box.contains(query) : box.meets(query);
        };
        std::vector<std::uint32_t> expected, found;
        for (std::uint32_t i = 0; i < count; ++i)
          if (enter(boxes[i]))
            expected.push_back(i);
        tree.visit(enter, [&](std::uint32_t item) {
          found.push_back(item);
          return false;
        });
        std::sort(found.begin(), found.end());
        EXPECT_EQ(found, expected);
        std::size_t calls = 0;
        tree.visit(enter, [&](std::uint32_t) { return ++calls == 1; });
        EXPECT_EQ(calls, std::min<std::size_t>(expected.size(), 1));
      }
    }
  }
}

TEST(BoxTree, FindsBoxesThatHaveMoved) {
  meshes::Random random(2);
  for (const std::size_t count : {1u, 7u, 500u}) {
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < count; ++i)
      boxes.push_back(randomBox(random, 3));
    BoxTree tree(boxes);
    for (int round = 0; round < 300; ++round) {
      const auto item = static_cast<std::uint32_t>(random.below(count));
      boxes[item] = round % 5 == 0 ? Box() : randomBox(random, round % 3 == 0 ? 15 : 2);
      tree.move(item, boxes[item]);
      const Box query = randomBox(random, 3);
      std::vector<std::uint32_t> expected, found;
      for (std::uint32_t i = 0; i < count; ++i)
        if (boxes[i].meets(query))
          expected.push_back(i);
      tree.visit([&](const Box& box) { return box.meets(query); },
                 [&](std::uint32_t i) {
                   found.push_back(i);
                   return false;
                 });
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, expected);
    }
  }
}

TEST(BoxTree, EmptyAndEqualBoxes) {
  const auto all = [](const Box&) { return true; };
  std::size_t found = 0;
  const auto counting = [&](std::uint32_t) {
    ++found;
    return false;
  };
  BoxTree(std::vector<Box>()).visit(all, counting);
  EXPECT_EQ(found, 0u);
  BoxTree(std::vector<Box>(50000, Box{{1, 1, 1}, {2, 2, 2}})).visit(all, counting);
  EXPECT_EQ(found, 50000u);
}

} // namespace
} // namespace tetvdb
