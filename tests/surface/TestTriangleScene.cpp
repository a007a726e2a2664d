// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/TriangleScene.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

using namespace tetvdb;
using namespace tetvdb::meshes;

namespace {

using Real = long double;

// Distance of p to triangle `face` by the Gram matrix of its sides, in long doubles.
Real distanceTo(const TriangleMesh& mesh, std::size_t face, const Vec3d& p) {
  Real v[3][3];
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      v[k][axis] = Real(mesh.points[mesh.triangles[3 * face + k]][axis]) - Real(p[axis]);
  const auto product = [](const Real* a, const Real* b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  };
  Real e[3], f[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    e[axis] = v[1][axis] - v[0][axis];
    f[axis] = v[2][axis] - v[0][axis];
  }
  const Real ee = product(e, e), ef = product(e, f), ff = product(f, f);
  const Real re = -product(v[0], e), rf = -product(v[0], f);
  const Real det = ee * ff - ef * ef;
  Real best = INFINITY;
  if (det > 0) { // by rounding alone for a needle: its sides are tried, too
    const Real s = (re * ff - rf * ef) / det, t = (rf * ee - re * ef) / det;
    if (s >= 0 && t >= 0 && s + t <= 1) {
      Real square = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Real x = v[0][axis] + s * e[axis] + t * f[axis];
        square += x * x;
      }
      best = std::sqrt(square);
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Real* a = v[k];
    const Real* b = v[(k + 1) % 3];
    const Real side[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const Real square = product(side, side);
    const Real t = square > 0 ? std::clamp(-product(a, side) / square, Real(0), Real(1)) : 0;
    const Real at[3] = {a[0] + t * side[0], a[1] + t * side[1], a[2] + t * side[2]};
    best = std::min(best, std::sqrt(product(at, at)));
  }
  return best;
}

Real bruteDistance(const TriangleMesh& mesh, const Vec3d& p) {
  Real best = INFINITY;
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face)
    best = std::min(best, distanceTo(mesh, face, p));
  return best;
}

// Triangles of every size and shape, needles and points among them.
TriangleMesh soup(Random& random, std::size_t count, double size) {
  TriangleMesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d at{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    const double reach = size * std::pow(10.0, random.between(-4, 0));
    for (std::size_t k = 0; k < 3; ++k)
      mesh.points.push_back({at[0] + reach * random.between(-1, 1),
                             at[1] + reach * random.between(-1, 1),
                             at[2] + reach * random.between(-1, 1)});
    if (i % 7 == 0)
      mesh.points.back() = mesh.points[mesh.points.size() - 2];
    if (i % 11 == 0)
      for (std::size_t axis = 0; axis < 3; ++axis)
        mesh.points.back()[axis] = 2 * mesh.points[3 * i + 1][axis] - mesh.points[3 * i][axis];
    const auto first = static_cast<std::uint32_t>(3 * i);
    addTriangle(mesh, first, first + 1, first + 2);
  }
  return mesh;
}

} // namespace

TEST(TriangleScene, ClosestPointsEqualBruteForce) {
  Random random(1);
  for (const Vec3d& shift : {Vec3d{0, 0, 0}, Vec3d{1e6, -3e5, 2e6}}) {
    TriangleMesh mesh = soup(random, 400, 0.5);
    for (Vec3d& p : mesh.points)
      for (std::size_t axis = 0; axis < 3; ++axis)
        p[axis] += shift[axis];
    const TriangleScene scene(mesh);
    std::uint32_t first = 0;
    for (int i = 0; i < 500; ++i) {
      const double reach = i % 5 == 0 ? 100 : 1.5;
      Vec3d p;
      for (std::size_t axis = 0; axis < 3; ++axis)
        p[axis] = shift[axis] + random.between(-reach, reach);
      const TriangleScene::Closest closest = scene.closest(p);
      const double expected = static_cast<double>(bruteDistance(mesh, p));
      ASSERT_NEAR(closest.distance, expected, 1e-13 * (1 + expected) + 1e-15 * std::abs(shift[2]));
      ASSERT_NEAR(static_cast<double>(distanceTo(mesh, closest.triangle, p)), expected,
                  1e-13 * (1 + expected));
      ASSERT_TRUE(scene.isWithin(p, closest.distance * (1 + 1e-9)));
      ASSERT_FALSE(scene.isWithin(p, closest.distance * (1 - 1e-9)));
      const std::uint32_t before = first;
      ASSERT_FALSE(scene.isWithin(p, closest.distance * (1 - 1e-9), &first));
      ASSERT_EQ(first, before);
      ASSERT_TRUE(scene.isWithin(p, closest.distance * 1.5, &first));
      ASSERT_LT(static_cast<double>(distanceTo(mesh, first, p)), closest.distance * 1.5);
      const Vec3d& q = closest.point;
      ASSERT_NEAR(std::hypot(q[0] - p[0], q[1] - p[1], q[2] - p[2]), closest.distance,
                  1e-12 * (1 + expected) + 1e-9 * (shift[0] > 0));
      ASSERT_LT(static_cast<double>(bruteDistance(mesh, q)), 1e-12 + 1e-9 * (shift[0] > 0));
    }
  }
}

TEST(TriangleScene, TiesGoToTheLowestTriangle) {
  // Every face twice, in reverse order, and points whose nearest point is on an edge or a vertex.
  const TriangleMesh once = box({0, 0, 0}, {1, 1, 1}, 4);
  TriangleMesh mesh = once;
  for (std::size_t face = once.triangleCount(); face-- > 0;)
    addTriangle(mesh, once.triangles[3 * face + 1], once.triangles[3 * face + 2],
                once.triangles[3 * face]);
  const TriangleScene scene(mesh);
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    Vec3d p;
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[axis] = static_cast<double>(random.below(33)) / 8 - 1.5;
    const Real best = bruteDistance(mesh, p);
    std::size_t lowest = 0;
    while (distanceTo(mesh, lowest, p) != best)
      ++lowest;
    ASSERT_EQ(scene.closest(p).triangle, lowest) << p[0] << ' ' << p[1] << ' ' << p[2];
  }
}

TEST(TriangleScene, FindsNothingBeyondTheLimit) {
  const TriangleMesh mesh = box();
  const TriangleScene scene(mesh);
  EXPECT_EQ(scene.closest({0.5, 0.5, 3}, 1.99).triangle, 0xFFFFFFFFu);
  EXPECT_EQ(scene.closest({0.5, 0.5, 3}, 2).triangle, 0xFFFFFFFFu);
  EXPECT_NEAR(scene.closest({0.5, 0.5, 3}, 2.01).distance, 2, 1e-15);
  EXPECT_TRUE(std::isinf(scene.closest({0.5, 0.5, 3}, 1).distance));
}

TEST(TriangleScene, EmptyAndPointlikeMeshes) {
  const TriangleMesh none;
  const TriangleScene empty(none);
  std::vector<TriangleScene::Hit> hits{{0, 0, false}};
  empty.crossings({0, 0, 0}, {1, 0, 0}, 1, hits);
  EXPECT_TRUE(hits.empty());
  EXPECT_TRUE(std::isinf(empty.closest({0, 0, 0}).distance));

  TriangleMesh dot;
  dot.points = {{5, 6, 7}, {1e9, 0, 0}};
  addTriangle(dot, 0, 0, 0);
  const TriangleScene scene(dot);
  EXPECT_NEAR(scene.closest({5, 6, 9}).distance, 2, 1e-15);
  scene.crossings({5, 6, 6}, {0, 0, 1}, 5, hits);
  EXPECT_TRUE(hits.empty());
}

TEST(TriangleScene, CrossingsOfNestedSpheresAlternate) {
  TriangleMesh mesh;
  for (int shell = 1; shell <= 5; ++shell) {
    const TriangleMesh one = sphere({100, 200, 300}, shell, 12);
    append(mesh, shell % 2 == 0 ? flipped(one) : one);
  }
  const TriangleScene scene(mesh);
  Random random(3);
  std::vector<TriangleScene::Hit> hits;
  for (int i = 0; i < 500; ++i) {
    Vec3d direction;
    for (double& d : direction)
      d = random.between(-1, 1);
    scene.crossings({100.01, 200.02, 299.97}, direction, 1e6, hits);
    ASSERT_EQ(hits.size(), 5u);
    for (std::size_t k = 0; k < 5; ++k) {
      ASSERT_EQ(hits[k].leaving, k % 2 == 0);
      const double r = hits[k].t * std::hypot(direction[0], direction[1], direction[2]);
      ASSERT_NEAR(r, double(k) + 1, 0.1 * (double(k) + 1));
      const Vec3d at{100.01 + hits[k].t * direction[0], 200.02 + hits[k].t * direction[1],
                     299.97 + hits[k].t * direction[2]};
      ASSERT_LT(static_cast<double>(distanceTo(mesh, hits[k].triangle, at)), 1e-6);
    }
    // From far outside the same faces come twice as many.
    const Vec3d far{100 - 1e7 * direction[0], 200 - 1e7 * direction[1], 300 - 1e7 * direction[2]};
    scene.crossings(far, direction, 2e7, hits);
    ASSERT_EQ(hits.size(), 10u);
    scene.crossings(far, direction, 1e6, hits);
    ASSERT_TRUE(hits.empty());
  }
}

TEST(TriangleScene, CrossingsCountAtBothEnds) {
  const TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1}, 3);
  const TriangleScene scene(mesh);
  std::vector<TriangleScene::Hit> hits;
  scene.crossings({0.2, 0.3, 0}, {0, 0, 1}, 1, hits);
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_EQ(hits[0].t, 0);
  EXPECT_FALSE(hits[0].leaving);
  EXPECT_EQ(hits[1].t, 1);
  EXPECT_TRUE(hits[1].leaving);
  scene.crossings({0.2, 0.3, 1e-12}, {0, 0, 1}, 0.999999999, hits);
  EXPECT_TRUE(hits.empty());
  scene.crossings({0.2, 0.3, -1}, {0, 0, 4}, 0.3, hits);
  ASSERT_EQ(hits.size(), 1u);
  EXPECT_EQ(hits[0].t, 0.25);
}

TEST(TriangleScene, RaysThroughEdgesHitOneOfTheirFacesAtLeast) {
  const TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1}, 8);
  const TriangleScene scene(mesh);
  std::vector<TriangleScene::Hit> hits;
  for (int i = 1; i < 8; ++i)
    for (int j = 1; j < 8; ++j) {
      scene.crossings({i / 8.0, j / 8.0, -3}, {0, 0, 1}, 10, hits);
      for (const double height : {3.0, 4.0})
        EXPECT_TRUE(std::any_of(hits.begin(), hits.end(),
                                [&](const TriangleScene::Hit& hit) { return hit.t == height; }));
    }
}

TEST(TriangleScene, QueriesAreTheSameInParallel) {
  const TriangleMesh mesh = torus(1, 0.4, 60, 30);
  std::vector<Vec3d> points(5000);
  Random random(4);
  for (Vec3d& p : points)
    p = {random.between(-2, 2), random.between(-2, 2), random.between(-1, 1)};
  const auto answers = [&](int threads) {
    std::vector<double> all(3 * points.size());
    tbb::task_arena arena(threads);
    arena.execute([&] {
      const TriangleScene scene(mesh);
      tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
        const TriangleScene::Closest closest = scene.closest(points[i]);
        std::vector<TriangleScene::Hit> hits;
        scene.crossings(points[i], {0.1, 0.2, 1}, 10, hits);
        all[3 * i] = closest.distance;
        all[3 * i + 1] = closest.triangle;
        all[3 * i + 2] = hits.empty() ? -1 : hits[0].t;
      });
    });
    return all;
  };
  EXPECT_EQ(answers(1), answers(4));
}
