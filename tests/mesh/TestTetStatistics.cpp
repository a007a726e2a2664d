// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/TetStatistics.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

TetMesh cornerTet() {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 4}, {9, 9, 9}};
  mesh.tets = {0, 1, 2, 3};
  mesh.cellCount = 1;
  return mesh;
}

TEST(TetStatistics, MeasuresWhatTetsUse) {
  const TetStatistics statistics = measure(cornerTet());
  EXPECT_DOUBLE_EQ(statistics.volume, 4.0);
  EXPECT_DOUBLE_EQ(statistics.boxVolume, 24.0);
  EXPECT_EQ(statistics.boxMin, (Vec3d{0, 0, 0}));
  EXPECT_EQ(statistics.boxMax, (Vec3d{2, 3, 4})); // the fifth point belongs to no tet
  EXPECT_EQ(statistics.inverted, 0u);
  EXPECT_EQ(statistics.flat, 0u);
}

TEST(TetStatistics, CountsInvertedAndFlat) {
  TetMesh mesh = cornerTet();
  mesh.points[4] = {0.1, 0.7, 0};
  mesh.tets.insert(mesh.tets.end(), {0, 2, 1, 3, 0, 1, 2, 4, 0, 0, 1, 2});
  const TetStatistics statistics = measure(mesh);
  EXPECT_DOUBLE_EQ(statistics.volume, 8.0);
  EXPECT_DOUBLE_EQ(statistics.boxVolume, 48.0); // of flat tets in a plane of the axes: none
  EXPECT_EQ(statistics.inverted, 1u);
  EXPECT_EQ(statistics.flat, 2u);
}

TEST(TetStatistics, FlatFarFromTheOriginIsFlatDespiteRounding) {
  TetMesh mesh;
  mesh.points = {
      {1e6 + 0.1, 1e6, 0.3}, {1e6 + 0.7, 1e6, 0.3}, {1e6, 1e6 + 0.9, 0.3}, {1e6, 1e6, 0.3}};
  mesh.tets = {0, 1, 2, 3};
  EXPECT_EQ(measure(mesh).flat, 1u);
}

TEST(TetStatistics, EmptyMesh) {
  const TetStatistics statistics = measure(TetMesh());
  EXPECT_EQ(statistics.volume, 0.0);
  EXPECT_EQ(statistics.boxMax, (Vec3d{0, 0, 0}));
}

TEST(TetStatistics, SameBitsForAnyThreadCount) {
  TetMesh mesh;
  for (std::uint32_t i = 0; i < 200000; ++i) {
    const double t = 0.001 * i;
    for (const Vec3d& p :
         {Vec3d{t, 0, 0}, Vec3d{t + 0.1, t, 0}, Vec3d{0, 1 / (t + 1), 0}, Vec3d{0, 0, t / 3}})
      mesh.points.push_back(p);
    for (std::uint32_t k = 0; k < 4; ++k)
      mesh.tets.push_back(4 * i + k);
  }
  const double expected = tbb::task_arena(1).execute([&] { return measure(mesh).volume; });
  for (const int threads : {2, 3, 8})
    EXPECT_EQ(tbb::task_arena(threads).execute([&] { return measure(mesh).volume; }), expected);
}

} // namespace
} // namespace tetvdb
