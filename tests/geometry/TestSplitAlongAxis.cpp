// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/SplitAlongAxis.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <tuple>
#include <vector>

namespace tetvdb {
namespace {

struct Item {
  Vec3d at;
  int number;
};
const Vec3d& placeOf(const Item& item) {
  return item.at;
}
int numberOf(const Item& item) {
  return item.number;
}

TEST(SplitAlongAxis, TheLongestAxisIsThatOfTheBoxTheFirstOfEqualOnes) {
  EXPECT_EQ(longestAxis(Vec3d{0, 0, 0}, Vec3d{1, 1, 1}), 0u);
  EXPECT_EQ(longestAxis(Vec3d{0, 0, 0}, Vec3d{1, 2, 2}), 1u);
  EXPECT_EQ(longestAxis(Vec3d{-3, 5, 1}, Vec3d{-2, 6, 4}), 2u);
  const std::vector<Item> items{{{0, 7, -1}, 0}, {{2, 7, 1}, 1}, {{1, 4, 0}, 2}};
  EXPECT_EQ(longestAxis(items.begin(), items.end(), placeOf), 1u);
}

// Against a full sort, with many items at equal places, in two orders.
TEST(SplitAlongAxis, TheFirstHalfIsThatOfASortedList) {
  std::mt19937 random(5);
  for (int round = 0; round < 50; ++round) {
    std::vector<Item> items;
    for (int i = 0; i < 200; ++i)
      items.push_back({{double(random() % 7), double(random() % 7), double(random() % 7)}, i});
    const std::size_t axis = random() % 3, nth = random() % 201;
    std::vector<Item> sorted = items;
    std::sort(sorted.begin(), sorted.end(), [&](const Item& a, const Item& b) {
      return std::tie(a.at[axis], a.number) < std::tie(b.at[axis], b.number);
    });
    std::set<int> expected;
    for (std::size_t i = 0; i < nth; ++i)
      expected.insert(sorted[i].number);
    for (int order = 0; order < 2; ++order) {
      std::shuffle(items.begin(), items.end(), random);
      splitAlongAxis(axis, items.begin(), items.begin() + std::ptrdiff_t(nth), items.end(), placeOf,
                     numberOf);
      std::set<int> found;
      for (std::size_t i = 0; i < nth; ++i)
        found.insert(items[i].number);
      EXPECT_EQ(found, expected);
    }
  }
}

} // namespace
} // namespace tetvdb
