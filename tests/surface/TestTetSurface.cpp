// SPDX-License-Identifier: Apache-2.0
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/surface/SplitFans.h"
#include "tetvdb/surface/TetSurface.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

using namespace tetvdb;
using namespace tetvdb::meshes;

namespace {

TriangleMesh surfaceOf(const TetMesh& mesh) {
  Progress progress;
  return tetSurface(mesh, progress);
}

double volumeOf(const TetMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.tets.size(); i += 4) {
    Vec3d e[3];
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        e[k][axis] = mesh.points[mesh.tets[i + k + 1]][axis] - mesh.points[mesh.tets[i]][axis];
    sum += std::abs(e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                    e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                    e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
           6;
  }
  return sum;
}

// Tets of the mesh for which keep(tet) holds.
template <class Keep>
TetMesh someOf(const TetMesh& mesh, const Keep& keep) {
  TetMesh some;
  some.points = mesh.points;
  for (std::size_t tet = 0; tet < mesh.tetCount(); ++tet)
    if (keep(tet))
      some.tets.insert(some.tets.end(), &mesh.tets[4 * tet], &mesh.tets[4 * tet] + 4);
  return some;
}

// Pieces that hang together by edges of the surface.
std::size_t pieces(const TriangleMesh& mesh) {
  std::vector<std::size_t> root(mesh.points.size());
  for (std::size_t v = 0; v < root.size(); ++v)
    root[v] = v;
  const auto find = [&](std::size_t v) {
    while (root[v] != v)
      v = root[v];
    return v;
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    root[find(mesh.triangles[i])] = find(mesh.triangles[i - i % 3]);
  std::size_t count = 0;
  for (std::size_t v = 0; v < root.size(); ++v)
    count += root[v] == v;
  return count;
}

} // namespace

TEST(TetSurface, OfAGridIsABox) {
  const TriangleMesh mesh = surfaceOf(kuhnGrid(3, 4, 5));
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_EQ(mesh.triangleCount(), 4u * (12 + 15 + 20));
  EXPECT_NEAR(signedVolume(mesh), 60, 1e-12);
}

TEST(TetSurface, TurnsNegativeTets) {
  TetMesh tets = kuhnGrid(3, 3, 3);
  for (std::size_t tet = 0; tet < tets.tetCount(); tet += 2)
    std::swap(tets.tets[4 * tet], tets.tets[4 * tet + 1]);
  const TriangleMesh mesh = surfaceOf(tets);
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_NEAR(signedVolume(mesh), 27, 1e-12);
}

TEST(TetSurface, PartsThatTouchAtAnEdgeAreParted) {
  // Two cubes of a 2 x 2 x 1 grid that share an edge.
  const TetMesh grid = kuhnGrid(2, 2, 1);
  const TetMesh diagonal =
      someOf(grid, [](std::size_t tet) { return tet / 6 == 0 || tet / 6 == 3; });
  const TriangleMesh mesh = surfaceOf(diagonal);
  EXPECT_EQ(manifoldDefect(mesh, false), "");
  EXPECT_EQ(pieces(mesh), 2u);
  EXPECT_EQ(mesh.points.size(), 16u);
  EXPECT_NEAR(signedVolume(mesh), 2, 1e-12);
}

TEST(TetSurface, PartsThatTouchAtAPointAreParted) {
  const TetMesh grid = kuhnGrid(2, 2, 2);
  const TetMesh corners =
      someOf(grid, [](std::size_t tet) { return tet / 6 == 0 || tet / 6 == 7; });
  const TriangleMesh mesh = surfaceOf(corners);
  EXPECT_EQ(manifoldDefect(mesh, false), "");
  EXPECT_EQ(pieces(mesh), 2u);
}

TEST(TetSurface, WedgesThatBothEndsOfAnEdgeJoinAreCut) {
  // Two cubes that touch along an edge, between two full layers: the faces around either end of the
  // edge form one fan, which passes it twice.
  const TetMesh grid = kuhnGrid(2, 2, 3);
  const TetMesh some = someOf(grid, [](std::size_t tet) {
    const std::size_t cube = tet / 6, z = cube % 3, column = cube / 3;
    return z != 1 || column == 0 || column == 3;
  });
  const TriangleMesh mesh = surfaceOf(some);
  EXPECT_EQ(manifoldDefect(mesh, false), "");
  EXPECT_NEAR(signedVolume(mesh), 10, 1e-12);
  EXPECT_EQ(pieces(mesh), 1u);
  const auto cut = std::count(mesh.points.begin(), mesh.points.end(), Vec3d{1, 1, 1.5});
  EXPECT_EQ(cut, 1);
}

TEST(TetSurface, RandomTetsOfALargerGrid) {
  Random random(8);
  for (const double share : {0.1, 0.5, 0.9}) {
    const TetMesh some =
        someOf(kuhnGrid(7, 8, 9), [&](std::size_t) { return random.unit() < share; });
    const TriangleMesh mesh = surfaceOf(some);
    EXPECT_EQ(manifoldDefect(mesh, false), "");
    EXPECT_NEAR(signedVolume(mesh), volumeOf(some), 1e-9);
  }
}

TEST(TetSurface, FlatTetsBetweenOthersVanish) {
  // Two tets over the two triangulations of a square, a flat one between.
  TetMesh tets;
  tets.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}, {0.5, 0.5, -1}};
  tets.tets = {0, 1, 2, 4, 0, 2, 3, 4, 0, 1, 3, 5, 1, 2, 3, 5, 0, 1, 2, 3};
  const TriangleMesh mesh = surfaceOf(tets);
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_EQ(mesh.triangleCount(), 8u);
  EXPECT_NEAR(signedVolume(mesh), 2.0 / 3, 1e-12);
}

TEST(TetSurface, TetsWithoutVolumeHaveNone) {
  TetMesh tets;
  tets.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {7, 7, 7}};
  tets.tets = {0, 1, 2, 3, 0, 1, 1, 2};
  EXPECT_THROW(surfaceOf(tets), Error);
  EXPECT_THROW(surfaceOf(TetMesh()), Error);
}

TEST(TetSurface, EqualTetsCountTwice) {
  TetMesh tets = kuhnGrid(1, 1, 1);
  const std::vector<std::uint32_t> once = tets.tets;
  tets.tets.insert(tets.tets.end(), once.begin(), once.end());
  const TriangleMesh mesh = surfaceOf(tets);
  EXPECT_EQ(manifoldDefect(mesh, false), "");
  EXPECT_NEAR(signedVolume(mesh), 2, 1e-12);
}

TEST(SplitFans, LeavesAManifoldAsItIs) {
  TriangleMesh mesh = torus();
  const TriangleMesh before = mesh;
  Progress progress;
  splitFans(mesh, progress);
  EXPECT_EQ(mesh.points, before.points);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(SplitFans, RefusesAnOpenSurface) {
  TriangleMesh open = sheet();
  Progress progress;
  EXPECT_THROW(splitFans(open, progress), Error);
}
