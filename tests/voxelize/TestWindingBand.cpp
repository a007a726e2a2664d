// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/voxelize/WindingBand.h"
#include "voxelize/WindingOracle.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <vector>

namespace tetvdb {
namespace {

constexpr double kVoxel = static_cast<double>(kUnitsPerVoxel);

// Triangles about `size` voxels long within `range` voxels.
std::vector<FillTriangle> scattered(std::size_t n, double size, double range, std::uint64_t seed) {
  meshes::Random random(seed);
  std::vector<FillTriangle> triangles;
  const auto place = [&](const Vec3d& c, double reach) {
    Vec3d p{};
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = c[k] + random.between(-reach, reach);
    return p;
  };
  const auto snap = [](const Vec3d& p) {
    return LatticePoint{std::round(p[0] * kVoxel), std::round(p[1] * kVoxel),
                        std::round(p[2] * kVoxel)};
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d c = place({0, 0, 0}, range);
    triangles.push_back({snap(place(c, size)), snap(place(c, size)), snap(place(c, size)), 1});
  }
  return triangles;
}

struct Judged {
  std::size_t evaluated = 0;
  double largest = 0, sum = 0;
};

// Every voxel that is evaluated against the definition, `stride` apart; and of the others none may
// be at a half, nor may any pass one from the voxel below.
Judged judge(const std::vector<FillTriangle>& triangles, int stride, int range) {
  const TriangleClusters tree(triangles);
  const Progress progress;
  const WindingBand band(tree, progress);
  std::map<std::array<int, 3>, double> found;
  test::forEvaluated(
      band, [&](const std::array<int, 3>& voxel, double winding) { found[voxel] = winding; });
  Judged judged;
  judged.evaluated = found.size();
  int count = 0;
  for (int x = -range; x <= range; ++x)
    for (int y = -range; y <= range; ++y)
      for (int z = -range; z <= range; ++z) {
        if (count++ % stride != 0)
          continue;
        const auto voxel = found.find({x, y, z});
        const double here = test::windingOf(triangles, {double(x), double(y), double(z)});
        if (voxel != found.end()) {
          const double error = std::abs(voxel->second - here);
          judged.largest = std::max(judged.largest, error);
          judged.sum += error;
          continue;
        }
        EXPECT_GT(std::abs(here - std::floor(here) - 0.5), kWindingBandError);
        // In ten steps, whole numbers aside.
        double before = here;
        for (int step = 1; step <= 10; ++step) {
          double now = test::windingOf(triangles, {double(x), double(y), z - step / 10.0});
          now -= std::round(now - before);
          EXPECT_EQ(std::floor(now + 0.5), std::floor(here + 0.5)) << x << ' ' << y << ' ' << z;
          before = now;
        }
      }
  return judged;
}

TEST(WindingBand, FewLargeTriangles) {
  const Judged judged = judge(scattered(12, 20, 20, 1), 37, 40);
  EXPECT_GT(judged.evaluated, 1000u);
  EXPECT_LT(judged.largest, kWindingBandError / 10);
}

TEST(WindingBand, ManySmallTriangles) {
  const Judged judged = judge(scattered(700, 2, 24, 2), 301, 30);
  EXPECT_GT(judged.evaluated, 1000u);
  EXPECT_LT(judged.largest, kWindingBandError / 10);
}

// So many that each may be wrong by more.
TEST(WindingBand, Tangle) {
  const Judged judged = judge(scattered(6000, 1.5, 24, 3), 2003, 26);
  EXPECT_GT(judged.evaluated, 1000u);
  EXPECT_LT(judged.largest, kWindingBandError);
}

TEST(WindingBand, NothingToFill) {
  const TriangleClusters tree({});
  const Progress progress;
  EXPECT_TRUE(WindingBand(tree, progress).nodes().empty());
}

TEST(WindingBand, WholeNumbersNearestToHalves) {
  EXPECT_EQ(nearestWinding(0.5), 0);
  EXPECT_EQ(nearestWinding(0.50005), 0);
  EXPECT_EQ(nearestWinding(0.501), 1);
  EXPECT_EQ(nearestWinding(-0.5), 0);
  EXPECT_EQ(nearestWinding(-0.501), -1);
  EXPECT_EQ(nearestWinding(1.5), 1);
  EXPECT_EQ(nearestWinding(2.2), 2);
}

} // namespace
} // namespace tetvdb
