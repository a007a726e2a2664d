// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/CompareMeshes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

using namespace tetvdb;
using namespace tetvdb::meshes;

namespace {

MeshDistance distance(const TriangleMesh& a, const TriangleMesh& b, std::size_t samples = 20000) {
  Progress progress;
  return compareMeshes(a, b, {samples}, progress);
}

} // namespace

TEST(CompareMeshes, AMeshIsAtNoDistanceFromItself) {
  const TriangleMesh mesh = torus();
  const MeshDistance same = distance(mesh, shuffledFaces(unwelded(mesh)));
  EXPECT_LT(same.hausdorff, 1e-15);
  EXPECT_GT(same.aToB.points, 20000u);
}

TEST(CompareMeshes, ShiftedPlanesAreOneShiftApart) {
  const MeshDistance d = distance(sheet(5, 0), sheet(7, 0.25));
  for (const OneSidedDistance& side : {d.aToB, d.bToA}) {
    EXPECT_NEAR(side.mean, 0.25, 1e-12);
    EXPECT_NEAR(side.rms, 0.25, 1e-12);
    EXPECT_NEAR(side.largest, 0.25, 1e-15);
  }
  EXPECT_NEAR(d.diagonal, std::sqrt(2 + 0.0625), 1e-15);
}

TEST(CompareMeshes, ConcentricSpheresAreTheirRadiiApart) {
  const MeshDistance d = distance(sphere({7, 8, 9}, 1, 40), sphere({7, 8, 9}, 1.5, 40));
  EXPECT_NEAR(d.aToB.mean, 0.5, 2e-3);
  EXPECT_NEAR(d.bToA.mean, 0.5, 2e-3);
  EXPECT_NEAR(d.hausdorff, 0.5, 4e-3);
}

TEST(CompareMeshes, TheTwoSidesDiffer) {
  // Half of a plane of area 1 against the whole: from the half nothing is far; from the whole the
  // distance grows evenly to 1/2 on one half and is 0 on the other.
  const TriangleMesh whole = sheet(8);
  const TriangleMesh half = without(whole, [&](std::size_t face) {
    double x = 0;
    for (std::size_t k = 0; k < 3; ++k)
      x += whole.points[whole.triangles[3 * face + k]][0];
    return x > 1.5;
  });
  const MeshDistance d = distance(half, whole, 200000);
  EXPECT_NEAR(d.aToB.largest, 0, 1e-15);
  EXPECT_EQ(d.bToA.largest, 0.5);
  EXPECT_EQ(d.bToA.where[0], 1);
  EXPECT_EQ(d.hausdorff, 0.5);
  EXPECT_NEAR(d.bToA.mean, 0.125, 1e-4);
  EXPECT_NEAR(d.bToA.rms, std::sqrt(0.5 / 12), 1e-4);
}

TEST(CompareMeshes, SamplesFollowTheArea) {
  // One side of the box has most of the faces, but a sixth of the area.
  TriangleMesh fine = box({0, 0, 0}, {1, 1, 1}, 40);
  const TriangleMesh top = without(fine, [&](std::size_t face) {
    for (std::size_t k = 0; k < 3; ++k)
      if (fine.points[fine.triangles[3 * face + k]][2] != 1)
        return true;
    return false;
  });
  const TriangleMesh coarse = box();
  TriangleMesh mixed = without(coarse, [&](std::size_t face) {
    for (std::size_t k = 0; k < 3; ++k)
      if (coarse.points[coarse.triangles[3 * face + k]][2] != 1)
        return false;
    return true;
  });
  append(mixed, top);
  // To the plane z = 0: the top 1, the bottom 0, the sides 1/2 on average.
  const MeshDistance d = distance(mixed, sheet(), 100000);
  EXPECT_NEAR(d.aToB.mean, (1 + 0 + 4 * 0.5) / 6, 1e-4);
  EXPECT_NEAR(d.aToB.largest, 1, 1e-15);
}

TEST(CompareMeshes, VerticesAreMeasuredToo) {
  // A needle that hardly any sample of the area meets.
  TriangleMesh needle = sheet(4);
  needle.points.push_back({0.5, 0.5, 3});
  needle.points.push_back({0.5, 0.5 + 1e-9, 0});
  addTriangle(needle, 12, static_cast<std::uint32_t>(needle.points.size() - 2),
              static_cast<std::uint32_t>(needle.points.size() - 1));
  const MeshDistance d = distance(needle, sheet(4), 1000);
  EXPECT_EQ(d.aToB.largest, 3);
  EXPECT_EQ(d.aToB.where, (Vec3d{0.5, 0.5, 3}));
}

TEST(CompareMeshes, MeshesWithoutAreaAreTheirVertices) {
  TriangleMesh point;
  point.points = {{0, 0, 2}, {100, 0, 0}};
  addTriangle(point, 0, 0, 0);
  const MeshDistance d = distance(point, sheet());
  EXPECT_EQ(d.aToB.mean, 2);
  EXPECT_EQ(d.aToB.points, 1u);
  EXPECT_NEAR(d.hausdorff, std::sqrt(6), 1e-15);
}

TEST(CompareMeshes, RefusesMeshesWithoutFaces) {
  TriangleMesh none;
  none.points = {{0, 0, 0}};
  EXPECT_THROW(distance(none, sheet()), Error);
  EXPECT_THROW(distance(sheet(), none), Error);
}

TEST(CompareMeshes, IndependentOfThreads) {
  const TriangleMesh a = torus(), b = sphere({0.1, 0.2, 0.3}, 1.1, 20);
  const auto measured = [&](int threads) {
    tbb::task_arena arena(threads);
    MeshDistance d;
    arena.execute([&] { d = distance(a, b, 50000); });
    return std::vector<double>{d.aToB.mean, d.aToB.rms,     d.aToB.largest, d.bToA.mean,
                               d.bToA.rms,  d.bToA.largest, d.hausdorff,    d.aToB.where[0],
                               d.diagonal,  d.bToA.where[0]};
  };
  EXPECT_EQ(measured(1), measured(2));
}
