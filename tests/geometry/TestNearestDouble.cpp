// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/NearestDouble.h"

#include <cstdint>
#include <gtest/gtest.h>
#include <random>

namespace {

using namespace tetvdb;

// Against the compiler's own conversion, ties to even and what lies next to them among the values.
TEST(NearestDouble, RoundsAsTheCompilerDoes) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 200000; ++i) {
    Int128 v = static_cast<Int128>(random()) << 62 ^ static_cast<Int128>(random());
    v >>= random() % 127;
    ASSERT_EQ(nearestDouble(v), static_cast<double>(v)) << i;
    ASSERT_EQ(nearestDouble(-v), static_cast<double>(-v)) << i;
  }
  for (int bits = 53; bits < 126; ++bits)
    for (std::uint64_t last = 0; last < 4; ++last)
      for (int off = -1; off <= 1; ++off) {
        // 53 bits that count, then a half of the last of them, and one more or less.
        const Int128 kept = (Int128(1) << 52 | static_cast<Int128>(last)) << (bits - 52);
        const Int128 v = kept + (Int128(1) << (bits - 53)) + off;
        ASSERT_EQ(nearestDouble(v), static_cast<double>(v)) << bits << " " << last << " " << off;
        ASSERT_EQ(nearestDouble(-v), static_cast<double>(-v)) << bits << " " << last << " " << off;
      }
  EXPECT_EQ(nearestDouble(0), 0.0);
}

} // namespace
