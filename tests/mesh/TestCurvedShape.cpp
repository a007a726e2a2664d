// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "QuadraticMesh.h"
#include "tetvdb/mesh/CurvedShape.h"

#include <cmath>
#include <gtest/gtest.h>

namespace {

using namespace tetvdb;

CurvedShape shapeOfKind(const meshes::QuadraticKind& kind) {
  return *curvedShape(kind.type, kind.nodes());
}

// A point of the reference cell: places weighted.
Vec3d inside(CurvedShape shape, meshes::Random& random) {
  Vec3d p{0, 0, 0};
  double sum = 0;
  for (std::size_t i = 0; i < nodeCount(shape); ++i) {
    const double w = random.between(0, 1) * random.between(0, 1);
    for (std::size_t k = 0; k < 3; ++k)
      p[k] += w * placeOf(shape, i)[k];
    sum += w;
  }
  return {p[0] / sum, p[1] / sum, p[2] / sum};
}

TEST(CurvedShape, FurtherNodesAreInTheMiddlesOfTheirCorners) {
  for (const auto& kind : meshes::quadraticKinds()) {
    const CurvedShape shape = shapeOfKind(kind);
    ASSERT_EQ(nodeCount(shape), kind.nodes()) << kind.name;
    for (std::size_t m = 0; m < kind.middles.size(); ++m)
      for (std::size_t k = 0; k < 3; ++k) {
        double midpoint = 0;
        for (const int c : kind.middles[m])
          midpoint += placeOf(shape, static_cast<std::size_t>(c))[k];
        EXPECT_NEAR(placeOf(shape, kind.corners.size() + m)[k],
                    midpoint / static_cast<double>(kind.middles[m].size()), 1e-15)
            << kind.name << " " << m;
      }
  }
}

TEST(CurvedShape, EachFunctionIsOneAtItsNodeAndZeroAtTheOthers) {
  for (const auto& kind : meshes::quadraticKinds()) {
    const CurvedShape shape = shapeOfKind(kind);
    for (std::size_t i = 0; i < kind.nodes(); ++i) {
      double values[kMaxCurvedNodes];
      shapeFunctions(shape, placeOf(shape, i), values);
      for (std::size_t k = 0; k < kind.nodes(); ++k)
        EXPECT_NEAR(values[k], i == k ? 1 : 0, 1e-7) << kind.name << " " << i << " " << k;
    }
  }
}

TEST(CurvedShape, QuadraticPolynomialsAreReproduced) {
  meshes::Random random(3);
  for (const auto& kind : meshes::quadraticKinds()) {
    const CurvedShape shape = shapeOfKind(kind);
    for (int round = 0; round < 200; ++round) {
      double c[10];
      for (double& one : c)
        one = random.between(-1, 1);
      const auto f = [&](const Vec3d& p) {
        return c[0] + c[1] * p[0] + c[2] * p[1] + c[3] * p[2] + c[4] * p[0] * p[0] +
               c[5] * p[1] * p[1] + c[6] * p[2] * p[2] + c[7] * p[0] * p[1] + c[8] * p[1] * p[2] +
               c[9] * p[0] * p[2];
      };
      const Vec3d at = inside(shape, random);
      double values[kMaxCurvedNodes], sum = 0;
      shapeFunctions(shape, at, values);
      for (std::size_t i = 0; i < kind.nodes(); ++i)
        sum += values[i] * f(placeOf(shape, i));
      ASSERT_NEAR(sum, f(at), 1e-13) << kind.name;
    }
  }
}

TEST(CurvedShape, GradientsAreThoseOfDifferences) {
  meshes::Random random(4);
  for (const auto& kind : meshes::quadraticKinds()) {
    const CurvedShape shape = shapeOfKind(kind);
    for (int round = 0; round < 20; ++round) {
      const Vec3d at = inside(shape, random);
      double values[kMaxCurvedNodes];
      std::array<double, 3> gradients[kMaxCurvedNodes];
      shapeFunctions(shape, at, values, gradients);
      for (std::size_t k = 0; k < 3; ++k) {
        const double step = 1e-6;
        Vec3d low = at, high = at;
        low[k] -= step;
        high[k] += step;
        double below[kMaxCurvedNodes], above[kMaxCurvedNodes];
        shapeFunctions(shape, low, below);
        shapeFunctions(shape, high, above);
        for (std::size_t i = 0; i < kind.nodes(); ++i)
          ASSERT_NEAR(gradients[i][k], (above[i] - below[i]) / (2 * step), 1e-6)
              << kind.name << " " << i;
      }
    }
  }
}

constexpr CurvedShape kLinearShapes[] = {CurvedShape::Hex8, CurvedShape::Wedge6,
                                         CurvedShape::Pyramid5};

TEST(CurvedShape, LinearFunctionsAreOneAtTheirNodes) {
  for (const CurvedShape shape : kLinearShapes) {
    EXPECT_TRUE(isLinear(shape));
    for (std::size_t i = 0; i < nodeCount(shape); ++i) {
      double values[kMaxCurvedNodes];
      shapeFunctions(shape, placeOf(shape, i), values);
      for (std::size_t k = 0; k < nodeCount(shape); ++k)
        EXPECT_NEAR(values[k], i == k ? 1 : 0, 2e-9) << i << " " << k;
    }
  }
}

TEST(CurvedShape, LinearPolynomialsAndGradients) {
  meshes::Random random(5);
  for (const CurvedShape shape : kLinearShapes)
    for (int round = 0; round < 100; ++round) {
      const Vec3d at = inside(shape, random);
      double values[kMaxCurvedNodes];
      std::array<double, 3> gradients[kMaxCurvedNodes];
      shapeFunctions(shape, at, values, gradients);
      const auto f = [](const Vec3d& p) { return 1 + 2 * p[0] - 3 * p[1] + 5 * p[2]; };
      double sum = 0, by[3] = {0, 0, 0};
      for (std::size_t i = 0; i < nodeCount(shape); ++i) {
        sum += values[i] * f(placeOf(shape, i));
        for (std::size_t k = 0; k < 3; ++k)
          by[k] += gradients[i][k] * f(placeOf(shape, i));
      }
      ASSERT_NEAR(sum, f(at), 1e-13);
      ASSERT_NEAR(by[0], 2, 1e-11);
      ASSERT_NEAR(by[1], -3, 1e-11);
      ASSERT_NEAR(by[2], 5, 1e-11);
    }
}

} // namespace
