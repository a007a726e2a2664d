// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/LayerFaces.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

namespace tetvdb {
namespace {

TEST(LayerFaces, EveryLayerHasItsFaces) {
  std::mt19937 random(1);
  for (const std::size_t pairs : {1u, 7u, 100u, 100000u}) {
    const std::int32_t layers = 50;
    std::vector<LayerRange> ranges;
    for (int i = 0; i < 200; ++i) { // some below, above, empty
      const std::int32_t first = std::int32_t(random() % 70) - 10;
      ranges.push_back({first, first - 2 + std::int32_t(random() % 20)});
    }
    LayerFaces faces(ranges, layers, pairs);
    std::int32_t k = 0;
    while (k < layers) {
      const LayerSlab slab = faces.next();
      EXPECT_EQ(slab.first, k);
      EXPECT_GT(slab.end(), k);
      for (; k < slab.end(); ++k) {
        const std::size_t i = std::size_t(k - slab.first);
        std::vector<std::uint32_t> found(slab.faces.begin() + std::ptrdiff_t(slab.starts[i]),
                                         slab.faces.begin() + std::ptrdiff_t(slab.starts[i + 1]));
        std::sort(found.begin(), found.end());
        std::vector<std::uint32_t> expected;
        for (std::uint32_t f = 0; f < ranges.size(); ++f)
          if (ranges[f].first <= k && k <= ranges[f].last)
            expected.push_back(f);
        EXPECT_EQ(found, expected);
      }
    }
    EXPECT_EQ(k, layers);
  }
}

} // namespace
} // namespace tetvdb
