// SPDX-License-Identifier: Apache-2.0
//
// The judge is judged by meshes whose faults are known.
#include "ExactVolume.h"
#include "TetMeshCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/geometry/BoxTree.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

constexpr TetCheckSamples kSamples = {4000, 500, 4000, 1};

// A cube of 6 * 4^3 tets, moved to coordinates that are not whole.
TetMesh cubeOfTets() {
  return meshes::scaled(meshes::kuhnGrid(4, 4, 4), 0.3, {0.1, -0.7, 5});
}
TriangleMesh cubeOfTriangles() {
  return meshes::box({0.1, -0.7, 5}, {1.3, 0.5, 6.2}, 3);
}

TetMesh withoutTet(TetMesh mesh, std::size_t tet) {
  const auto at = mesh.tets.begin() + static_cast<std::ptrdiff_t>(4 * tet);
  mesh.tets.erase(at, at + 4);
  mesh.cellCount = mesh.tetCount();
  return mesh;
}

TEST(TetMeshCheck, ACubeIsFine) {
  const TetMeshCheck check = checkTetMesh(cubeOfTets(), cubeOfTriangles(), 0.01, kSamples);
  EXPECT_EQ(check.faults(), "") << check.json();
  EXPECT_EQ(check.tets, 384u);
  EXPECT_EQ(check.surfaceFaces, 192u);
  EXPECT_NEAR(check.volume, 1.728, 1e-12);
  EXPECT_NEAR(check.enclosedVolume, 1.728, 1e-12);
  EXPECT_TRUE(check.closedInput);
  EXPECT_LT(check.outToIn, 1e-14);
  EXPECT_LT(check.inToOut, 1e-14);
  EXPECT_EQ(check.farPoints, 0u);
  EXPECT_GT(check.windingPoints, 450u);
  // Half the sum of the squared edges, 1, 1, 1, 2, 2, 3; a volume of sqrt(2) regular tets.
  EXPECT_NEAR(check.meanEnergy, 5 / std::cbrt(2.0), 1e-9);
  EXPECT_NEAR(check.worstEnergy, 5 / std::cbrt(2.0), 1e-9);
  EXPECT_NEAR(check.smallestAngle, 45, 1e-9);
  EXPECT_NEAR(check.largestAngle, 90, 1e-9);
}

TEST(TetMeshCheck, ARegularTetHasEnergyThree) {
  TetMesh mesh;
  mesh.points = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.tets = {0, 2, 1, 3};
  mesh.cellCount = 1;
  TriangleMesh input;
  input.points = mesh.points;
  input.triangles = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};
  const TetMeshCheck check = checkTetMesh(mesh, input, 0.01, kSamples);
  EXPECT_EQ(check.faults(), "") << check.json();
  EXPECT_NEAR(check.worstEnergy, 3, 1e-12);
  EXPECT_NEAR(check.smallestAngle, std::acos(1.0 / 3) * 180 / kPi, 1e-9);
}

TEST(TetMeshCheck, FindsNegativeAndFlatTets) {
  TetMesh negative = cubeOfTets();
  std::swap(negative.tets[400], negative.tets[401]);
  const TetMeshCheck turned = checkTetMesh(negative, cubeOfTriangles(), 0.01, kSamples);
  EXPECT_EQ(turned.notPositive, 1u);
  EXPECT_GT(turned.wrongFaces, 0u);
  TetMesh flat = cubeOfTets();
  flat.points.push_back(flat.points[flat.tets[0]]);
  flat.tets[1] = static_cast<std::uint32_t>(flat.points.size() - 1);
  EXPECT_EQ(checkTetMesh(flat, cubeOfTriangles(), 0.01, kSamples).notPositive, 1u);
}

TEST(TetMeshCheck, FindsOverlaps) {
  TetMesh twice = cubeOfTets();
  for (std::size_t i = 0; i < 4; ++i)
    twice.tets.push_back(twice.tets[i]);
  twice.cellCount = twice.tetCount();
  const TetMeshCheck check = checkTetMesh(twice, cubeOfTriangles(), 0.01, kSamples);
  EXPECT_GT(check.overlappingPoints, 0u);
  EXPECT_GT(check.wrongFaces, 0u);

  TetMesh reaching = cubeOfTets(); // an inner point goes beyond the tets around it
  for (Vec3d& p : reaching.points)
    if (p == Vec3d{2 * 0.3 + 0.1, 2 * 0.3 - 0.7, 2 * 0.3 + 5})
      p[0] += 0.4;
  const TetMeshCheck crossed = checkTetMesh(reaching, cubeOfTriangles(), 0.01, kSamples);
  EXPECT_GT(crossed.notPositive, 0u);
  EXPECT_GT(crossed.overlappingPoints, 0u);
  EXPECT_EQ(crossed.wrongFaces, 0u);
}

TEST(TetMeshCheck, FindsAHole) {
  TetMeshCheck check =
      checkTetMesh(withoutTet(cubeOfTets(), 190), cubeOfTriangles(), 0.01, {4000, 20000, 4000, 1});
  EXPECT_EQ(check.notPositive, 0u);
  EXPECT_GT(check.outToIn, 0.05);
  EXPECT_GT(check.wrongPoints, 0u);
  EXPECT_EQ(check.faults(), "far-surface wrong-side");
}

TEST(TetMeshCheck, FindsTheCubeTooSmallOrTooLarge) {
  for (const double size : {0.295, 0.305}) {
    const TetMesh other = meshes::scaled(meshes::kuhnGrid(4, 4, 4), size, {0.1, -0.7, 5});
    const double off = 4 * std::abs(size - 0.3); // at the far sides
    const TetMeshCheck loose = checkTetMesh(other, cubeOfTriangles(), 0.04, kSamples);
    EXPECT_EQ(loose.faults(), "") << loose.json();
    EXPECT_NEAR(loose.outToIn, size > 0.3 ? off * std::sqrt(3.0) : off, 1e-3);
    EXPECT_NEAR(loose.inToOut, size > 0.3 ? off : off * std::sqrt(3.0), 1e-3);
    const TetMeshCheck strict = checkTetMesh(other, cubeOfTriangles(), 0.001, kSamples);
    EXPECT_EQ(strict.faults(), "far-surface wrong-side") << strict.json();
    EXPECT_GT(strict.farPoints, 1000u);
    // Half an epsilon off a side's boundary is another side.
    EXPECT_GT(strict.lostPoints, 0.95 * static_cast<double>(strict.judgedFarPoints));
  }
}

TEST(TetMeshCheck, InnerWallsAreNotOwed) {
  TriangleMesh input = cubeOfTriangles();
  meshes::append(input, meshes::box({0.4, -0.4, 5.3}, {1, 0.2, 5.9}));
  const TetMeshCheck check = checkTetMesh(cubeOfTets(), input, 0.01, kSamples);
  EXPECT_EQ(check.faults(), "") << check.json();
  EXPECT_NEAR(check.inToOut, 0.3, 1e-12);
  EXPECT_GT(check.farPoints, 500u);
  EXPECT_GT(check.judgedFarPoints, 500u);
  EXPECT_EQ(check.lostPoints, 0u);
}

TEST(TetMeshCheck, AnotherSolidIsOwed) {
  TriangleMesh input = cubeOfTriangles();
  meshes::append(input, meshes::box({3, 3, 3}, {4, 4, 4}));
  const TetMeshCheck check = checkTetMesh(cubeOfTets(), input, 0.01, kSamples);
  EXPECT_GT(check.lostPoints, 500u);
  EXPECT_GT(check.wrongPoints, 0u);
}

TEST(TetMeshCheck, TetsOutsideCountForValidityAlone) {
  const TetMesh cube = cubeOfTets();
  TetMesh mesh = meshes::scaled(meshes::kuhnGrid(6, 6, 6), 0.3, {-0.2, -1, 4.7});
  mesh.cellCount = mesh.tetCount();
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    Vec3d centre{0, 0, 0};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        centre[axis] += mesh.points[mesh.tets[4 * t + i]][axis] / 4;
    const bool inside = centre[0] > 0.1 && centre[0] < 1.3 && centre[1] > -0.7 && centre[1] < 0.5 &&
                        centre[2] > 5 && centre[2] < 6.2;
    mesh.regions.push_back(inside ? 1 : -1);
  }
  const TetMeshCheck check = checkTetMesh(mesh, cubeOfTriangles(), 0.01, kSamples);
  EXPECT_EQ(check.faults(), "") << check.json();
  EXPECT_EQ(check.tets, 1296u);
  EXPECT_EQ(check.insideTets, cube.tetCount());
  EXPECT_NEAR(check.volume, 1.728, 1e-12);
}

TEST(TetMeshCheck, OpenInputsHaveNoFarSurface) {
  TriangleMesh open = cubeOfTriangles();
  open.triangles.resize(open.triangles.size() - 3 * 18); // of the last side
  const TetMeshCheck check = checkTetMesh(cubeOfTets(), open, 0.01, kSamples);
  EXPECT_FALSE(check.closedInput);
  EXPECT_GT(check.outToIn, 0.3);
  EXPECT_EQ(check.faults().find("far-surface"), std::string::npos);
}

TEST(ExactVolume, SignsOfSmallWholeNumbers) {
  meshes::Random random(4);
  for (int round = 0; round < 20000; ++round) {
    exact_volume::Point p[4];
    long long whole[4][3];
    const int bits = static_cast<int>(random.below(19));
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        whole[i][axis] = static_cast<long long>(random.between(-1, 1) * std::exp2(bits));
        p[i][axis] = static_cast<double>(whole[i][axis]);
      }
    long long m[3][3];
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        m[i][axis] = whole[i + 1][axis] - whole[0][axis];
    const long long det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                          m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                          m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    const int sign = (det > 0) - (det < 0);
    EXPECT_EQ(exact_volume::sign(p[0], p[1], p[2], p[3]), sign);
    EXPECT_EQ(exact_volume::signByWholes(p[0], p[1], p[2], p[3]), sign);
  }
}

TEST(ExactVolume, SignsOfPointsAPlaneAlmostHolds) {
  meshes::Random random(5);
  for (int round = 0; round < 2000; ++round) {
    // d = b + c - a exactly, then the next double up or down along an axis: the sign is that of the
    // plane's normal along it.
    exact_volume::Point a, b, c, d;
    const double size = std::exp2(random.between(-200, 200));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double unit = std::exp2(std::floor(std::log2(size)) - 30);
      a[axis] = std::floor(random.between(-1, 1) * 0x1p30) * unit;
      b[axis] = std::floor(random.between(-1, 1) * 0x1p30) * unit;
      c[axis] = std::floor(random.between(-1, 1) * 0x1p30) * unit;
      d[axis] = b[axis] + c[axis] - a[axis];
    }
    EXPECT_EQ(exact_volume::sign(a, b, c, d), 0);
    const std::size_t axis = random.below(3), i = (axis + 1) % 3, k = (axis + 2) % 3;
    const double normal =
        (b[i] - a[i]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[i] - a[i]); // 62 bits, seldom near 0
    if (std::abs(normal) < size * size * 1e-6)
      continue;
    const int sign = normal > 0 ? 1 : -1;
    exact_volume::Point above = d, below = d;
    above[axis] = std::nextafter(d[axis], Box::kInfinity);
    below[axis] = std::nextafter(d[axis], -Box::kInfinity);
    EXPECT_EQ(exact_volume::sign(a, b, c, above), sign);
    EXPECT_EQ(exact_volume::sign(a, b, c, below), -sign);
    EXPECT_EQ(exact_volume::sign(b, a, c, above), -sign);
  }
}

} // namespace
} // namespace tetvdb
