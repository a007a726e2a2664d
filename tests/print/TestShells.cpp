// SPDX-License-Identifier: Apache-2.0
#include "MeshOracles.h"
#include "TriangleMeshes.h"
#include "tetvdb/print/Shells.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

// A block with a small and a large cavity; in the large one a block with a cavity of its own.
TriangleMesh nested() {
  return meshes::joined(
      {meshes::box({0, 0, 0}, {20, 20, 20}), meshes::flipped(meshes::box({1, 1, 1}, {2, 2, 3})),
       meshes::flipped(meshes::box({4, 4, 4}, {16, 16, 16})), meshes::box({6, 6, 6}, {10, 10, 10}),
       meshes::flipped(meshes::box({7, 7, 7}, {8, 8, 8}))});
}

TEST(Shells, AreCountedAndMeasured) {
  const Shells shells = findShells(nested());
  ASSERT_EQ(shells.volumes.size(), 5u);
  EXPECT_EQ(shells.cavities(), 3u);
  EXPECT_DOUBLE_EQ(shells.volumes[0], 8000);
  EXPECT_DOUBLE_EQ(shells.volumes[2], -1728);
  EXPECT_DOUBLE_EQ(shells.volume(), 8000 - 2 - 1728 + 64 - 1);
}

TEST(Shells, OfSmallCavitiesGoWithWhatIsInThem) {
  TriangleMesh mesh = nested();
  FilledCavities filled = fillCavities(mesh, 3);
  EXPECT_EQ(filled.cavities, 2u);
  EXPECT_DOUBLE_EQ(filled.volume, 3);
  EXPECT_EQ(mesh.triangleCount(), 36u);
  EXPECT_DOUBLE_EQ(meshes::signedVolume(mesh), 8000 - 1728 + 64);
  mesh = nested();
  filled = fillCavities(mesh, 1729);
  EXPECT_EQ(filled.cavities, 3u);
  EXPECT_EQ(mesh.triangleCount(), 12u);
  EXPECT_DOUBLE_EQ(meshes::signedVolume(mesh), 8000);
  EXPECT_DOUBLE_EQ(filled.volume, 2 + 1728 - 64 + 1);
  EXPECT_TRUE(oracles::isClosedManifold(mesh));
}

TEST(Shells, OfIslandsGo) {
  // What lies in the large cavity, as the cavity's faces see it: without the block around it.
  TriangleMesh mesh = meshes::joined({meshes::flipped(meshes::box({4, 4, 4}, {16, 16, 16})),
                                      meshes::box({6, 6, 6}, {10, 10, 10}),
                                      meshes::flipped(meshes::box({7, 7, 7}, {8, 8, 8}))});
  const FilledCavities gone = dropIslands(mesh);
  EXPECT_EQ(gone.cavities, 1u);
  EXPECT_EQ(mesh.triangleCount(), 12u);
  EXPECT_DOUBLE_EQ(meshes::signedVolume(mesh), -1728);
}

TEST(Shells, OfLargeCavitiesStay) {
  TriangleMesh mesh = nested();
  EXPECT_EQ(fillCavities(mesh, 0.99).cavities, 0u);
  EXPECT_EQ(mesh.triangleCount(), 60u);
}

} // namespace
} // namespace tetvdb
