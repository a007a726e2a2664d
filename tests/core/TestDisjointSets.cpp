// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/DisjointSets.h"

#include <gtest/gtest.h>
#include <random>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

// The smallest element of each element's set, by a search along the pairs.
std::vector<std::uint32_t>
smallestReached(std::size_t count,
                const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
  std::vector<std::vector<std::uint32_t>> others(count);
  for (const auto& [a, b] : pairs) {
    others[a].push_back(b);
    others[b].push_back(a);
  }
  std::vector<std::uint32_t> smallest(count, 0xFFFFFFFFu);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::vector<std::uint32_t> open{i};
    while (!open.empty()) {
      const std::uint32_t at = open.back();
      open.pop_back();
      if (smallest[at] != 0xFFFFFFFFu)
        continue;
      smallest[at] = i;
      open.insert(open.end(), others[at].begin(), others[at].end());
    }
  }
  return smallest;
}

TEST(DisjointSets, JoinedFromSeveralThreads) {
  constexpr std::uint32_t kCount = 20000;
  std::mt19937 generator(7);
  const auto random = [&] { return static_cast<std::uint32_t>(generator()); };
  for (const std::size_t pairCount : {kCount / 4, kCount / 2, 2 * kCount}) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs(pairCount);
    for (auto& [a, b] : pairs) {
      a = random() % kCount;
      // Long chains as well as large sets.
      b = random() % 2 == 0 ? (a + 1) % kCount : random() % kCount;
    }
    DisjointSets sets(kCount);
    tbb::parallel_for(std::size_t(0), pairs.size(),
                      [&](std::size_t i) { sets.join(pairs[i].first, pairs[i].second); });
    const std::vector<std::uint32_t> expected = smallestReached(kCount, pairs);
    for (std::uint32_t i = 0; i < kCount; ++i)
      ASSERT_EQ(sets.find(i), expected[i]);
  }
}

} // namespace
} // namespace tetvdb
