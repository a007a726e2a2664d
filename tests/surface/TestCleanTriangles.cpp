// SPDX-License-Identifier: Apache-2.0
#include "TestScale.h"
#include "surface/CleanedSolids.h"
#include "tetvdb/core/Error.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

using namespace meshes;

// --- Points and faces.

TEST(CleanTriangles, CleanMeshStaysAsItIs) {
  for (const TriangleMesh& mesh : {box(), sphere(), torus(), cylinder(), sheet(), moebius(),
                                   flipped(sheet()), cylinder(1, 1, 32, false)}) {
    TriangleMesh copy = mesh;
    const CleanCounts counts = clean(copy);
    EXPECT_EQ(copy.points, mesh.points);
    EXPECT_EQ(copy.triangles, mesh.triangles);
    EXPECT_EQ(counts.weldedPoints + counts.unreferencedPoints + counts.degenerateFaces +
                  counts.duplicateFaces + counts.flippedFaces + counts.flippedParts,
              0u);
    EXPECT_FALSE(counts.insideOut);
  }
}

TEST(CleanTriangles, EmptyMesh) {
  TriangleMesh mesh;
  clean(mesh);
  EXPECT_EQ(mesh.triangleCount(), 0u);
  mesh.points = {{0, 0, 0}, {1, 2, 3}};
  EXPECT_EQ(clean(mesh).unreferencedPoints, 2u);
  EXPECT_TRUE(mesh.points.empty());
}

TEST(CleanTriangles, SoupIsWelded) {
  const TriangleMesh mesh = torus();
  TriangleMesh soup = unwelded(mesh);
  const CleanCounts counts = clean(soup);
  EXPECT_EQ(soup.points.size(), mesh.points.size());
  EXPECT_EQ(counts.weldedPoints, mesh.triangles.size() - mesh.points.size());
  EXPECT_EQ(counts.unreferencedPoints, 0u);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    ASSERT_EQ(soup.points[soup.triangles[i]], mesh.points[mesh.triangles[i]]);
}

TEST(CleanTriangles, NegativeZeroIsZero) {
  TriangleMesh soup = unwelded(box());
  for (std::size_t i = 0; i < soup.points.size(); i += 2)
    for (double& coordinate : soup.points[i])
      coordinate = coordinate == 0 ? -0.0 : coordinate;
  clean(soup);
  EXPECT_EQ(soup.points.size(), 8u);
}

TEST(CleanTriangles, WeldDistance) {
  Random random(2);
  const TriangleMesh soup = moved(unwelded(box()), [&](Vec3d p) {
    for (double& coordinate : p)
      coordinate += random.between(-1e-4, 1e-4);
    return p;
  });
  TriangleMesh near = soup, apart = soup;
  CleanOptions options;
  options.weldDistance = 1e-3;
  clean(near, options);
  clean(apart);
  EXPECT_EQ(near.points.size(), 8u);
  EXPECT_EQ(apart.points.size(), 36u);
  options.weldDistance = 10; // all becomes one point
  TriangleMesh nothing = soup;
  EXPECT_EQ(clean(nothing, options).degenerateFaces, 12u);
  EXPECT_EQ(nothing.triangleCount(), 0u);
  for (const double bad : {-1.0, std::nan("")}) {
    options.weldDistance = bad;
    EXPECT_THROW(clean(nothing, options), Error);
  }
}

TEST(CleanTriangles, OnlyFacesWithARepeatedPointAreDegenerate) {
  TriangleMesh mesh = box();
  addTriangle(mesh, 3, 5, 3);
  addTriangle(mesh, 1, 1, 1);
  mesh.points.push_back(mesh.points[2]);
  addTriangle(mesh, 2, 8, 4); // repeated once welded
  mesh.points.push_back({9, 9, 9});
  const CleanCounts counts = clean(mesh);
  EXPECT_EQ(counts.degenerateFaces, 3u);
  EXPECT_EQ(counts.weldedPoints, 1u);
  EXPECT_EQ(counts.unreferencedPoints, 1u);
  EXPECT_EQ(mesh.triangleCount(), 12u);
}

// A needle without area closes the T-junction on the edge from (0,0,0) to (2,0,0).
TEST(CleanTriangles, CollinearFacesStay) {
  TriangleMesh mesh;
  mesh.points = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, -1, 0}};
  addTriangle(mesh, 0, 1, 3);
  addTriangle(mesh, 2, 0, 4);
  addTriangle(mesh, 1, 2, 4);
  addTriangle(mesh, 0, 2, 1);
  const TriangleMesh before = mesh;
  EXPECT_EQ(clean(mesh).degenerateFaces, 0u);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

// --- Duplicates.

TEST(CleanTriangles, DoubledModelKeepsOneCopy) {
  for (const TriangleMesh& mesh :
       {sphere(), torus(), without(sphere(), [](std::size_t face) { return face % 97 < 3; })})
    for (const bool reversed : {false, true})
      for (const int copies : {2, 3, 4}) {
        TriangleMesh all = mesh;
        for (int copy = 1; copy < copies; ++copy)
          append(all, reversed ? flipped(mesh) : mesh);
        const CleanCounts counts = clean(all);
        EXPECT_EQ(counts.duplicateFaces, mesh.triangleCount() * std::size_t(copies - 1));
        EXPECT_EQ(all.triangleCount(), mesh.triangleCount());
        expectSameSolid(all, mesh);
      }
}

TEST(CleanTriangles, PartlyDoubledModelKeepsOneCopyOfEach) {
  const TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1}, 6);
  Random random(4);
  for (const double share : {0.05, 0.5, 0.95})
    for (const bool reversed : {false, true}) {
      TriangleMesh all = mesh;
      append(all, without(reversed ? flipped(mesh) : mesh,
                          [&](std::size_t) { return random.unit() > share; }));
      clean(all);
      EXPECT_EQ(all.triangleCount(), mesh.triangleCount());
      expectSolid(all, inBox(0, 1));
    }
}

TEST(CleanTriangles, WallBetweenTwoBoxesDisappears) {
  for (const int n : {1, 4}) {
    TriangleMesh mesh = joined({box({0, 0, 0}, {1, 1, 1}, n), box({1, 0, 0}, {2, 1, 1}, n)});
    const CleanCounts counts = clean(mesh);
    // Opposite sides of a box have the same diagonals here, seen from within the box's plane.
    EXPECT_EQ(counts.duplicateFaces, std::size_t(4 * n * n));
    EXPECT_EQ(mesh.triangleCount(), std::size_t(20 * n * n));
    expectSolid(mesh, [](const Vec3d& p) {
      return p[0] > 0 && p[0] < 2 && std::min(p[1], p[2]) > 0 && std::max(p[1], p[2]) < 1;
    });
  }
}

TEST(CleanTriangles, WallsOfAGridOfBoxesDisappear) {
  TriangleMesh mesh;
  for (int i = 0; i < 27; ++i) {
    const Vec3d low{double(i % 3), double(i / 3 % 3), double(i / 9)};
    append(mesh, box(low, {low[0] + 1, low[1] + 1, low[2] + 1}));
  }
  clean(mesh);
  EXPECT_EQ(mesh.triangleCount(), 6u * 9 * 2);
  EXPECT_NEAR(signedVolume(mesh), 27, 1e-12);
}

TEST(CleanTriangles, WallBetweenTwoDoubledBoxesDisappears) {
  const TriangleMesh pair = joined({box(), box({1, 0, 0}, {2, 1, 1})});
  TriangleMesh mesh = joined({pair, flipped(pair)});
  clean(mesh);
  EXPECT_EQ(mesh.triangleCount(), 20u);
  EXPECT_NEAR(signedVolume(mesh), 2, 1e-12);
}

TEST(CleanTriangles, OfCopiesTheMoreCommonOrientationStays) {
  TriangleMesh mesh = sheet(1);
  append(mesh, flipped(sheet(1)));
  append(mesh, flipped(sheet(1)));
  CleanOptions options;
  options.orient = false;
  clean(mesh, options);
  EXPECT_EQ(mesh.triangles, cleaned(flipped(sheet(1))).triangles);
  TriangleMesh kept = joined({sheet(1), sheet(1)});
  options.duplicates = false;
  EXPECT_EQ(clean(kept, options).duplicateFaces, 0u);
  EXPECT_EQ(kept.triangleCount(), 4u);
}

// The wall has more faces than either box without it: all are there twice, the wall four times.
TEST(CleanTriangles, LargeWallBetweenTwoDoubledBoxesDisappears) {
  const auto withWallCut = [](TriangleMesh mesh, double x) {
    for (int round = 0; round < 3; ++round)
      for (std::size_t face = 0, faces = mesh.triangleCount(); face < faces; ++face) {
        const std::array<std::uint32_t, 3> v{mesh.triangles[3 * face], mesh.triangles[3 * face + 1],
                                             mesh.triangles[3 * face + 2]};
        const Vec3d &a = mesh.points[v[0]], &b = mesh.points[v[1]], &c = mesh.points[v[2]];
        if (a[0] != x || b[0] != x || c[0] != x)
          continue;
        // Sums of the same three numbers, whatever their order.
        const auto midpoint = static_cast<std::uint32_t>(mesh.points.size());
        Vec3d sum;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          std::array<double, 3> sorted{a[axis], b[axis], c[axis]};
          std::sort(sorted.begin(), sorted.end());
          sum[axis] = axis == 0 ? x : (sorted[0] + sorted[1] + sorted[2]) / 3;
        }
        mesh.points.push_back(sum);
        mesh.triangles[3 * face + 2] = midpoint;
        addTriangle(mesh, v[1], v[2], midpoint);
        addTriangle(mesh, v[2], v[0], midpoint);
      }
    return mesh;
  };
  const TriangleMesh pair =
      joined({withWallCut(box(), 1), withWallCut(box({1, 0, 0}, {2, 1, 1}), 1)});
  ASSERT_EQ(pair.triangleCount(), 2u * (10 + 54));
  TriangleMesh mesh = joined({pair, pair});
  clean(mesh);
  EXPECT_EQ(mesh.triangleCount(), 20u);
  EXPECT_NEAR(signedVolume(mesh), 2, 1e-12);
}

// The wall goes, a side of the left box that touches it and is there twice stays.
TEST(CleanTriangles, WallNextToADoubledSideDisappears) {
  const TriangleMesh left = box();
  TriangleMesh mesh = joined({left, box({1, 0, 0}, {2, 1, 1})});
  append(mesh, without(left, [](std::size_t face) { return face < 10; }));
  EXPECT_EQ(clean(mesh).duplicateFaces, 4u + 2u);
  EXPECT_EQ(mesh.triangleCount(), 20u);
  EXPECT_NEAR(signedVolume(mesh), 2, 1e-12);
}

// Most of a sheet is there twice, once with each side up: the rest says which side it is.
TEST(CleanTriangles, CopiesWithoutASideFollowTheRest) {
  const auto rest = [](std::size_t face) { return face < 5; };
  const TriangleMesh twice = without(sheet(), rest);
  for (const bool turned : {false, true}) {
    TriangleMesh mesh = sheet();
    if (turned)
      mesh =
          joined({without(sheet(), [&](std::size_t face) { return !rest(face); }), flipped(twice)});
    append(mesh, turned ? twice : flipped(twice));
    clean(mesh);
    ASSERT_EQ(mesh.triangleCount(), 32u);
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
      const Vec3d &a = mesh.points[mesh.triangles[i]], &b = mesh.points[mesh.triangles[i + 1]],
                  &c = mesh.points[mesh.triangles[i + 2]];
      EXPECT_GT((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]), 0);
    }
  }
}

// --- Numbers that are hard, and many of them.

TEST(CleanTriangles, OffsetsAndScales) {
  for (const double scale : {1e-6, 1.0, 1e9})
    for (const double offset : {0.0, 1e6, -1e8}) {
      const auto place = [&](const Vec3d& p) {
        return Vec3d{scale * p[0] + offset, scale * p[1] - offset, scale * p[2] + offset};
      };
      const TriangleMesh mesh = moved(joined({ball(1), ball(0.5, true)}), place);
      if (scale < 1 && offset != 0)
        continue; // below the coordinates' resolution
      EXPECT_EQ(cleaned(mesh).triangles, mesh.triangles) << scale << " " << offset;
      EXPECT_EQ(cleaned(flipped(mesh)).triangles, mesh.triangles) << scale << " " << offset;
    }
}

TEST(CleanTriangles, NeedlesAndFlatParts) {
  TriangleMesh mesh = box();
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), {{5, 0, 0}, {6, 0, 0}, {5.5, 1e-12, 0}, {5.5, -1e-300, 0}});
  addTriangle(mesh, first, first + 1, first + 2);
  addTriangle(mesh, first + 1, first, first + 3);
  const TriangleMesh before = mesh;
  CleanOptions exact;
  exact.weldDistance = 0; // the needles are one but for rounding
  clean(mesh, exact);
  EXPECT_EQ(mesh.triangles, before.triangles);
  // A flat tetrahedron: closed, without volume.
  TriangleMesh flat;
  flat.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  flat.triangles = {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0};
  const TriangleMesh flatBefore = flat;
  EXPECT_EQ(cleaned(flat).triangles, flatBefore.triangles);
}

TEST(CleanTriangles, ShuffledFacesGiveTheSameSolid) {
  const TriangleMesh mesh = withFacesFlipped(
      joined({ball(1), ball(0.5, true), torus(2, 0.3), torus(2, 0.3), box({1, 1, 1}, {2, 2, 2})}),
      0.2);
  for (std::uint64_t seed = 0; seed < 3; ++seed)
    EXPECT_NEAR(signedVolume(cleaned(shuffledFaces(mesh, seed))), signedVolume(cleaned(mesh)),
                1e-9);
}

TEST(CleanTriangles, IsTheSameForAnyNumberOfThreads) {
  TriangleMesh mesh;
  Random random(9);
  for (int i = 0; i < 300; ++i) {
    const Vec3d at{random.between(0, 9), random.between(0, 9), random.between(0, 9)};
    append(mesh, withFacesFlipped(sphere(at, random.between(0.05, 3), 6), 0.3, std::uint64_t(i)));
  }
  TriangleMesh one = mesh, four = mesh;
  tbb::task_arena(1).execute([&] { clean(one); });
  tbb::task_arena(4).execute([&] { clean(four); });
  EXPECT_EQ(one.triangles, four.triangles);
  EXPECT_EQ(one.points, four.points);
}

double secondsToClean(TriangleMesh mesh) {
  const auto start = std::chrono::steady_clock::now();
  clean(mesh);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// None of these may grow with the square of anything: they would take hours.
TEST(CleanTriangles, ManyPartsTakeNoLongerThanTheirFaces) {
  TriangleMesh apart, nested = box({-1, -1, -1}, {101, 101, 101});
  for (int i = 0; i < 10000; ++i) {
    const Vec3d at{double(i % 100), double(i / 100), 0.5};
    append(apart, sphere(at, 0.4, 1));
    append(nested, sphere(at, 0.4, 1));
  }
  EXPECT_LT(secondsToClean(apart), 30 * test::kSlower);
  EXPECT_LT(secondsToClean(nested), 30 * test::kSlower);
  Random random(1);
  TriangleMesh soup;
  for (int i = 0; i < 300000; ++i)
    soup.points.push_back({random.unit(), random.unit(), random.unit()});
  soup = unwelded([&] {
    TriangleMesh mesh = soup;
    for (std::uint32_t i = 0; i < 300000; ++i)
      mesh.triangles.push_back(i);
    return mesh;
  }());
  EXPECT_LT(secondsToClean(soup), 30 * test::kSlower);
}

TEST(CleanTriangles, PointOfTenThousandFacesAndEdgeOfThreeThousand) {
  const TriangleMesh disc = cylinder(1, 1, 10000);
  EXPECT_EQ(cleaned(withFacesFlipped(disc, 0.2)).triangles, disc.triangles);
  TriangleMesh book;
  book.points = {{0, 0, 0}, {0, 0, 1}};
  for (std::uint32_t page = 0; page < 3000; ++page) {
    const double angle = 2 * kPi * page / 3000;
    book.points.push_back({std::cos(angle), std::sin(angle), 0.5});
    addTriangle(book, 0, 1, page + 2);
  }
  EXPECT_LT(secondsToClean(book), 30 * test::kSlower);
  EXPECT_LT(secondsToClean(joined({book, book, book, book})), 30 * test::kSlower);
}

TEST(CleanTriangles, CanBeCancelled) {
  TriangleMesh mesh = torus();
  Progress progress;
  progress.cancel();
  EXPECT_THROW(cleanTriangles(mesh, {}, progress), Error);
}

} // namespace
} // namespace tetvdb
