// SPDX-License-Identifier: Apache-2.0
//
// Rows by parity against rows that are summed voxel by voxel.
#include "tetvdb/voxelize/ParityRows.h"

#include <gtest/gtest.h>
#include <random>

namespace tetvdb {
namespace {

TEST(ParityRows, AreRowsThatAreSummed) {
  std::mt19937_64 random(3);
  std::uint64_t in[kParityRows][2], out[kParityRows][2], inside[kParityRows][2],
      failed[kParityRows];
  std::int32_t sums[kParityRows];
  int stays = 0, leaves = 0;
  for (int run = 0; run < 300; ++run) {
    for (int r = 0; r < kParityRows; ++r) {
      in[r][0] = in[r][1] = out[r][0] = out[r][1] = 0;
      sums[r] = random() % 8 == 0 ? static_cast<std::int32_t>(random() % 7) - 3
                                  : static_cast<std::int32_t>(random() % 2);
      // Crossings in turn, so that the sum stays, but for some that come at random.
      bool within = sums[r] == 1;
      for (int z = 0; z < 128; ++z) {
        const bool any = random() % 16 == 0, both = random() % 64 == 0;
        const bool enters = random() % 400 == 0 ? within : !within;
        if (!any && !both)
          continue;
        const std::uint64_t bit = std::uint64_t(1) << (z & 63);
        if (both || enters)
          in[r][z >> 6] |= bit;
        if (both || !enters)
          out[r][z >> 6] |= bit;
        within = both ? within : enters;
      }
    }
    const bool any = parityRows(in, out, sums, inside, failed);
    bool expected = false;
    for (int r = 0; r < kParityRows; ++r) {
      std::int32_t sum = sums[r];
      bool fails = sum != 0 && sum != 1;
      std::uint64_t row[2] = {0, 0};
      for (int z = 0; z < 128; ++z) {
        sum += static_cast<std::int32_t>(in[r][z >> 6] >> (z & 63) & 1);
        sum -= static_cast<std::int32_t>(out[r][z >> 6] >> (z & 63) & 1);
        fails = fails || (sum != 0 && sum != 1);
        if (sum == 1)
          row[z >> 6] |= std::uint64_t(1) << (z & 63);
      }
      ASSERT_EQ(failed[r] != 0, fails) << run << " " << r;
      expected = expected || fails;
      fails ? ++leaves : ++stays;
      if (!fails) {
        ASSERT_EQ(inside[r][0], row[0]);
        ASSERT_EQ(inside[r][1], row[1]);
      }
    }
    EXPECT_EQ(any, expected);
  }
  EXPECT_GT(stays, 1000);
  EXPECT_GT(leaves, 1000);
}

} // namespace
} // namespace tetvdb
