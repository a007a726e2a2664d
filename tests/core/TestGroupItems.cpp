// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/GroupItems.h"

#include <array>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <vector>

namespace tetvdb {
namespace {

struct Item {
  std::array<int, 2> place;
  std::size_t number;
  const std::array<int, 2>& key() const { return place; }
  bool operator<(const Item& o) const {
    return place != o.place ? place < o.place : number < o.number;
  }
};

TEST(GroupItems, HoldsTheNumbersOfEachKeyInOrder) {
  std::mt19937 random(1);
  for (const std::size_t count : {0u, 1u, 7u, 1000u, 5000u})
    for (const int keys : {1, 3, 100}) {
      // Up to three items of each number.
      std::vector<std::vector<std::array<int, 2>>> places(count);
      std::map<std::array<int, 2>, std::vector<std::size_t>> expected;
      for (std::size_t i = 0; i < count; ++i)
        for (unsigned k = random() % 4; k > 0; --k) {
          const std::array<int, 2> place{static_cast<int>(random() % unsigned(keys)) - keys / 2,
                                         static_cast<int>(k)};
          places[i].push_back(place);
          expected[place].push_back(i);
        }
      Progress progress;
      const auto grouped = groupItems<Item>(
          count, 64,
          [&](std::size_t i, std::vector<Item>& out) {
            for (const auto& place : places[i])
              out.push_back({place, i});
          },
          progress);
      ASSERT_EQ(grouped.groupCount(), expected.size());
      std::size_t group = 0;
      for (const auto& [place, numbers] : expected) {
        ASSERT_EQ(grouped.starts[group + 1] - grouped.starts[group], numbers.size());
        for (std::size_t i = 0; i < numbers.size(); ++i) {
          EXPECT_EQ(grouped.items[grouped.starts[group] + i].place, place);
          EXPECT_EQ(grouped.items[grouped.starts[group] + i].number, numbers[i]);
        }
        ++group;
      }
      EXPECT_EQ(grouped.starts.back(), grouped.items.size());
    }
}

} // namespace
} // namespace tetvdb
