// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/WideInteger.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace tetvdb {
namespace {

using Wide = WideInteger<6>;

TEST(WideInteger, SmallOnesAreAsInt128) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    const auto a = static_cast<std::int64_t>(random()) >> (i % 60);
    const auto b = static_cast<std::int64_t>(random()) >> (i % 47);
    const Int128 product = Int128(a) * b, sum = Int128(a) + b, difference = Int128(a) - b;
    EXPECT_EQ((Wide(a) * Wide(b) - Wide(product)).sign(), 0);
    EXPECT_EQ((Wide(a) + Wide(b) - Wide(sum)).sign(), 0);
    EXPECT_EQ((Wide(a) - Wide(b)).sign(), signOf(difference));
    EXPECT_EQ((-Wide(product)).sign(), -signOf(product));
    EXPECT_NEAR(Wide(product).toDouble() / (double(a) * double(b)), 1, 1e-15);
  }
}

// Values of some 300 bits whose difference is known.
TEST(WideInteger, LargeOnesDifferByOne) {
  std::mt19937_64 random(2);
  const auto number = [&] {
    return Int128(static_cast<std::int64_t>(random())) * (Int128(1) << 32);
  };
  for (int i = 0; i < 500; ++i) {
    const Wide a(number()), b(number()), c(number()), one(1);
    // (ab + 1)(c - 1) against abc - ab + c - 1
    const Wide left = (a * b + one) * (c - one);
    const Wide right = a * (b * c) - b * a + c - one;
    EXPECT_EQ((left - right).sign(), 0);
    EXPECT_EQ((left + one - right).sign(), 1);
    EXPECT_EQ((left - one - right).sign(), -1);
    EXPECT_NEAR((a * b * c).toDouble() / (a.toDouble() * b.toDouble() * c.toDouble()), 1, 1e-14);
  }
}

} // namespace
} // namespace tetvdb
