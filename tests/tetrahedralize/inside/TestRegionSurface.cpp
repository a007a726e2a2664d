// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "TriangleMeshes.h"
#include "tetvdb/surface/TetSurface.h"
#include "tetvdb/tetrahedralize/inside/RegionSurface.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

RegionSurface surfaceOf(const TetMesh& mesh) {
  Progress progress;
  return regionSurface(mesh, progress);
}

// A region for each tet, by its centre.
template <typename Region>
TetMesh withRegions(TetMesh mesh, const Region& region) {
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    Vec3d centre{0, 0, 0};
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        centre[axis] += mesh.points[mesh.tets[4 * t + k]][axis] / 4;
    mesh.regions.push_back(region(centre));
  }
  return mesh;
}

TriangleMesh firstFaces(const TriangleMesh& mesh, std::size_t count) {
  return meshes::without(mesh, [&](std::size_t face) { return face >= count; });
}

TEST(RegionSurface, IsTheOutsideTurnedOutward) {
  TetMesh mesh = meshes::jittered(meshes::kuhnGrid(5, 4, 3), 0.2, 1, true);
  for (std::size_t t = 0; t < mesh.tetCount(); t += 3)
    std::swap(mesh.tets[4 * t], mesh.tets[4 * t + 1]); // negative
  const RegionSurface surface = surfaceOf(mesh);
  Progress progress;
  const TriangleMesh expected = tetSurface(mesh, progress);
  EXPECT_EQ(surface.mesh.triangleCount(), expected.triangleCount());
  EXPECT_EQ(surface.outerFaces, expected.triangleCount());
  EXPECT_NEAR(meshes::signedVolume(surface.mesh), meshes::signedVolume(expected), 1e-9);
  EXPECT_NEAR(surface.volume, meshes::signedVolume(expected), 1e-9);
}

TEST(RegionSurface, HasFacesBetweenRegionsOnce) {
  const TetMesh mesh =
      withRegions(meshes::kuhnGrid(4, 4, 4), [](const Vec3d& p) { return p[0] < 2 ? 7 : 1; });
  const RegionSurface surface = surfaceOf(mesh);
  EXPECT_EQ(surface.outerFaces, 12u * 16);
  EXPECT_EQ(surface.mesh.triangleCount(), 12u * 16 + 2 * 16);
  for (std::size_t i = 3 * surface.outerFaces; i < surface.mesh.triangles.size(); ++i)
    EXPECT_EQ(surface.mesh.points[surface.mesh.triangles[i]][0], 2);
  EXPECT_NEAR(surface.volume, 64, 1e-9);
  EXPECT_NEAR(meshes::signedVolume(firstFaces(surface.mesh, surface.outerFaces)), 64, 1e-9);
}

TEST(RegionSurface, LeavesTheOutsideOut) {
  const TetMesh mesh =
      withRegions(meshes::kuhnGrid(4, 4, 4), [](const Vec3d& p) { return p[0] < 1 ? -1 : 1; });
  const RegionSurface surface = surfaceOf(mesh);
  EXPECT_EQ(surface.outerFaces, surface.mesh.triangleCount());
  EXPECT_NEAR(surface.volume, 48, 1e-9);
  EXPECT_NEAR(meshes::signedVolume(surface.mesh), 48, 1e-9);
}

} // namespace
} // namespace tetvdb
