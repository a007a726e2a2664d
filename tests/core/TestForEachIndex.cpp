// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/ForEachIndex.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

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
