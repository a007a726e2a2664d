// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/core/GroupItems.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <tbb/task_arena.h>
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

TEST(ForEachIndex, SumsDoNotDependOnThreads) {
  // Sums of these depend on the order.
  const auto value = [](std::size_t i) { return std::pow(-1.7, static_cast<double>(i % 90)); };
  const auto sumBy = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return sumOver(100000, value); });
  };
  const double sum = sumBy(1);
  for (const int threads : {2, 3, 7})
    EXPECT_EQ(sumBy(threads), sum);
  EXPECT_EQ(sumOver(10, [](std::size_t i) { return static_cast<double>(i); }), 45.0);
  EXPECT_EQ(sumOver(0, value), 0.0);
}

} // namespace
} // namespace tetvdb
