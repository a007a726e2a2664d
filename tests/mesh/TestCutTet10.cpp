// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "Tet10Mesh.h"
#include "mesh/OpenFaces.h"
#include "tetvdb/mesh/CutTet10.h"
#include "tetvdb/mesh/SplitCells.h"

#include <cmath>
#include <gtest/gtest.h>

namespace {

using namespace tetvdb;

double volumeOf(const TetMesh& mesh, std::size_t t) {
  double e[3][3];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      e[i][k] = mesh.points[mesh.tets[4 * t + i + 1]][k] - mesh.points[mesh.tets[4 * t]][k];
  return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
          e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
          e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
         6;
}

TetMesh splitTet10(CellMesh mesh, Report* report = nullptr) {
  Report own;
  Progress progress;
  return splitCells(std::move(mesh), {}, report == nullptr ? own : *report, progress);
}

TEST(CutTet10, EightPositiveTetsThatFillTheCell) {
  const TetMesh linear = meshes::jittered(meshes::kuhnGrid(2, 2, 2), 0.2, 1);
  Report report;
  const TetMesh mesh = splitTet10(meshes::tet10(linear, [](const Vec3d& p) { return p; }), &report);
  EXPECT_TRUE(report.warnings.empty());
  ASSERT_EQ(mesh.tetCount(), 8 * linear.tetCount());
  ASSERT_EQ(mesh.curved.cellOfTet.size(), mesh.tetCount());
  EXPECT_EQ(mesh.cellCount, linear.tetCount());
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    EXPECT_NEAR(volumeOf(mesh, t), volumeOf(linear, t / 8) / 8, 1e-15);
    EXPECT_EQ(mesh.cell(t), t / 8);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(mesh.tets[4 * t + i],
                mesh.curved.nodes[10 * mesh.curved.cellOfTet[t] + mesh.curved.corners[t][i]]);
  }
}

// Every face of the eight is shared by two, or is one of four of the cell's four faces.
TEST(CutTet10, FacesMatch) {
  const TetMesh mesh = splitTet10(meshes::tet10(meshes::kuhnGrid(2, 1, 1), [](const Vec3d& p) {
    return Vec3d{p[0] + 0.1 * p[1] * p[1], p[1] - 0.07 * p[2] * p[0], p[2] + 0.05 * p[0] * p[0]};
  }));
  // The block's 20 triangles, four of each.
  EXPECT_EQ(meshes::openFaces(mesh), 20u * 4);
}

// A ball of curved cells has more of the ball than its corners say.
TEST(CutTet10, FollowsCurvedEdges) {
  const auto onBall = [](const Vec3d& p) {
    const Vec3d q{p[0] - 1, p[1] - 1, p[2] - 1};
    const double shell = std::max({std::abs(q[0]), std::abs(q[1]), std::abs(q[2])});
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    const double s = length > 0 ? shell / length : 0;
    return Vec3d{q[0] * s, q[1] * s, q[2] * s};
  };
  const TetMesh cube = meshes::kuhnGrid(2, 2, 2);
  const auto sum = [](const TetMesh& mesh) {
    double volume = 0;
    for (std::size_t t = 0; t < mesh.tetCount(); ++t)
      volume += volumeOf(mesh, t);
    return volume;
  };
  const double ball = 4 * std::acos(-1.0) / 3;
  const double byCorners = sum(meshes::mapped(cube, onBall));
  const double curved = sum(splitTet10(meshes::tet10(cube, onBall)));
  EXPECT_LT(byCorners, 0.77 * ball);
  EXPECT_GT(curved, 0.9 * ball);
  EXPECT_LT(curved, ball);
}

} // namespace
