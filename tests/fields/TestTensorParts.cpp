// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/mesh/TensorParts.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace {

using namespace tetvdb;

TEST(TensorParts, MisesOfLoadsFromTextbooks) {
  EXPECT_DOUBLE_EQ(misesOf({-5, 0, 0, 0, 0, 0, 0, 0, 0}), 5);                 // uniaxial
  EXPECT_DOUBLE_EQ(misesOf({7, 0, 0, 0, 7, 0, 0, 0, 7}), 0);                  // hydrostatic
  EXPECT_DOUBLE_EQ(misesOf({0, 2, 0, 2, 0, 0, 0, 0, 0}), 2 * std::sqrt(3.0)); // shear
  EXPECT_DOUBLE_EQ(misesOf({0, 4, 0, 0, 0, 0, 0, 0, 0}), 2 * std::sqrt(3.0)); // its symmetric part
}

TEST(TensorParts, DeterminantAndTrace) {
  EXPECT_DOUBLE_EQ(determinantOf({2, 0, 1, 1, 3, 0, 0, 1, 4}), 25);
  EXPECT_DOUBLE_EQ(traceOf({2, 0, 1, 1, 3, 0, 0, 1, 4}), 9);
}

// Eigenvalues by what defines them: their sum, sum of products and product.
TEST(TensorParts, PrincipalsAreRootsOfTheCharacteristicPolynomial) {
  meshes::Random random(1);
  for (int round = 0; round < 2000; ++round) {
    const double size = std::pow(10, random.between(-9, 9));
    const auto number = [&] { return size * random.between(-1, 1); };
    const double a = number(), b = number(), c = number();
    const double d = round % 5 == 0 ? 0 : number(), e = number(), f = round % 7 == 0 ? 0 : number();
    const auto p = principalsOf({a, d, f, d, b, e, f, e, c});
    ASSERT_GE(p[0], p[1]);
    ASSERT_GE(p[1], p[2]);
    ASSERT_NEAR(p[0] + p[1] + p[2], a + b + c, 1e-14 * 3 * size);
    ASSERT_NEAR(p[0] * p[1] + p[1] * p[2] + p[2] * p[0],
                a * b + b * c + c * a - d * d - e * e - f * f, 1e-13 * size * size);
    ASSERT_NEAR(p[0] * p[1] * p[2], determinantOf({a, d, f, d, b, e, f, e, c}),
                1e-13 * size * size * size);
  }
}

TEST(TensorParts, WhatIsNotFiniteHasNoPrincipals) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double p : principalsOf({1, 0, 0, 0, nan, 0, 0, 0, 1}))
    EXPECT_TRUE(std::isnan(p));
}

} // namespace
