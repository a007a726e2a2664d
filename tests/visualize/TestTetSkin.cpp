// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "TriangleMeshes.h"
#include "tetvdb/surface/TetSurface.h"
#include "tetvdb/visualize/TetSkin.h"

#include <gtest/gtest.h>
#include <set>

namespace tetvdb {
namespace {

double areaOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face) {
    const Vec3d &a = mesh.points[mesh.triangles[3 * face]],
                &b = mesh.points[mesh.triangles[3 * face + 1]],
                &c = mesh.points[mesh.triangles[3 * face + 2]];
    const Vec3d u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    sum +=
        std::sqrt(std::pow(u[1] * v[2] - u[2] * v[1], 2) + std::pow(u[2] * v[0] - u[0] * v[2], 2) +
                  std::pow(u[0] * v[1] - u[1] * v[0], 2)) /
        2;
  }
  return sum;
}

TEST(TetSkin, TheOutsideOfABlock) {
  Progress progress;
  const TetMesh block = meshes::kuhnGrid(3, 4, 5);
  const TetSkin skin = tetSkin(block, std::nullopt, 0.8, progress);
  EXPECT_EQ(skin.mesh.triangleCount(), 2U * 2 * (3 * 4 + 4 * 5 + 3 * 5));
  EXPECT_NEAR(areaOf(skin.mesh), 2 * (3 * 4 + 4 * 5 + 3 * 5), 1e-9);
  EXPECT_NEAR(meshes::signedVolume(skin.mesh), 60, 1e-9); // outward
  EXPECT_EQ(skin.cutTets, 0U);
}

TEST(TetSkin, OutwardWhicheverWayTetsAreTurned) {
  Progress progress;
  TetMesh block = meshes::kuhnGrid(3, 3, 3);
  for (std::size_t tet = 0; tet < block.tetCount(); tet += 2)
    std::swap(block.tets[4 * tet + 1], block.tets[4 * tet + 2]);
  EXPECT_NEAR(meshes::signedVolume(tetSkin(block, std::nullopt, 1, progress).mesh), 27, 1e-9);
}

TEST(TetSkin, TheSameFacesAsTheSurfaceRoom) {
  Progress progress;
  const TetMesh ball = meshes::ball(8, 1, {0, 0, 0});
  const TetSkin skin = tetSkin(ball, std::nullopt, 1, progress);
  const TriangleMesh surface = tetSurface(ball, progress);
  EXPECT_EQ(skin.mesh.triangleCount(), surface.triangleCount());
  EXPECT_NEAR(areaOf(skin.mesh), areaOf(surface), 1e-9);
  EXPECT_EQ(skin.mesh.points.size(), surface.points.size());
}

// A plane through the middle of the third of six layers of cubes: those tets stand by themselves,
// shrunk, the layers before it are a block.
TEST(TetSkin, ACut) {
  Progress progress;
  const TetMesh block = meshes::kuhnGrid(6, 2, 2);
  const TetSkin skin = tetSkin(block, CutPlane{{1, 0, 0}, 2.5}, 0.5, progress);
  EXPECT_EQ(skin.cutTets, 2U * 2 * 6);
  const std::size_t outside = 2U * 2 * (2 * 2 + 2 * 2 + 2 * 2);
  EXPECT_EQ(skin.mesh.triangleCount(), outside + 4 * 24);
  // 8 of the block; of the cut layer an eighth of 4.
  EXPECT_NEAR(meshes::signedVolume(skin.mesh), 8 + 4 * 0.125, 1e-9);
  double largest = 0;
  for (const Vec3d& p : skin.mesh.points)
    largest = std::max(largest, p[0]);
  EXPECT_LT(largest, 3);
  EXPECT_GT(largest, 2);
}

// A plane between layers meets no tet.
TEST(TetSkin, ACutBetweenLayers) {
  Progress progress;
  const TetMesh block = meshes::kuhnGrid(6, 2, 2);
  const TetSkin skin = tetSkin(block, CutPlane{{-1, 0, 0}, -2.0}, 0.5, progress); // keeps x >= 2
  EXPECT_EQ(skin.cutTets, 0U);
  EXPECT_NEAR(meshes::signedVolume(skin.mesh), 16, 1e-9);
  EXPECT_TRUE(tetSkin(block, CutPlane{{1, 0, 0}, -1.0}, 1, progress).mesh.triangles.empty());
}

TEST(TetSkin, ValuesGoWithTheirTetsAndPoints) {
  Progress progress;
  const TetMesh block = meshes::kuhnGrid(4, 2, 2);
  const TetSkin skin = tetSkin(block, CutPlane{{1, 0, 0}, 2.5}, 1, progress);
  SurfaceValues x;
  x.on = SurfaceValues::On::Points;
  for (const Vec3d& p : block.points)
    x.values.push_back(static_cast<float>(p[0]));
  const SurfaceValues onSkin = skin.values(x);
  ASSERT_EQ(onSkin.values.size(), skin.mesh.points.size());
  for (std::size_t i = 0; i < onSkin.values.size(); ++i)
    EXPECT_NEAR(onSkin.values[i], skin.mesh.points[i][0], 1e-12);
  SurfaceValues number;
  number.on = SurfaceValues::On::Faces;
  for (std::size_t tet = 0; tet < block.tetCount(); ++tet)
    number.values.push_back(static_cast<float>(tet));
  const SurfaceValues onFaces = skin.values(number);
  ASSERT_EQ(onFaces.values.size(), skin.mesh.triangleCount());
  for (std::size_t face = 0; face < onFaces.values.size(); ++face) {
    // All corners of the face are of the tet.
    const auto tet = static_cast<std::size_t>(onFaces.values[face]);
    const std::set<std::uint32_t> corners(&block.tets[4 * tet], &block.tets[4 * tet] + 4);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(corners.count(skin.pointOf[skin.mesh.triangles[3 * face + k]]), 1U);
  }
}

TEST(TetSkin, Energies) {
  TetMesh mesh;
  mesh.points = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, // regular
                 {0, 0, 0}, {1, 0, 0},   {0, 1, 0},   {0, 0, 1},   // a corner
                 {0, 0, 0}, {1, 0, 0},   {0, 1, 0},   {1, 1, 0}};  // flat
  mesh.tets = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 5, 4, 6, 7};
  const std::vector<float> energies = tetEnergies(mesh);
  EXPECT_NEAR(energies[0], 3, 1e-6);
  // Squared edges add up to 3 + 3 * 2 = 9, six times the volume is 1.
  EXPECT_NEAR(energies[1], std::cbrt(9 * 9 * 9 / 16.0), 1e-5);
  EXPECT_EQ(energies[2], INFINITY);
  EXPECT_FLOAT_EQ(energies[3], energies[1]); // turned
}

} // namespace
} // namespace tetvdb
