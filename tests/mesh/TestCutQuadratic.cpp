// SPDX-License-Identifier: Apache-2.0
#include "QuadraticMesh.h"
#include "mesh/OpenFaces.h"
#include "tetvdb/mesh/CutQuadratic.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/mesh/SplitPolyhedron.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>

namespace {

using namespace tetvdb;

TetMesh split(CellMesh mesh, Report* report = nullptr) {
  Report own;
  Progress progress;
  return splitCells(std::move(mesh), {}, report == nullptr ? own : *report, progress);
}

Vec3d same(const Vec3d& p) {
  return p;
}
Vec3d bent(const Vec3d& p) {
  return {p[0] + 0.1 * p[1] * p[1], p[1] - 0.07 * p[2] * p[0], p[2] + 0.05 * p[0] * p[0]};
}
double number(const Vec3d& p) {
  return 1 + p[0] - 2 * p[1] + p[2];
}

double volumeOf(const TetMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    const std::uint32_t* n = mesh.tets.data() + 4 * t;
    sum += std::abs(sixfoldVolume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]],
                                  mesh.points[n[3]])) /
           6;
  }
  return sum;
}

TEST(CutQuadratic, StraightCellsAreFilled) {
  for (const auto& kind : meshes::quadraticKinds()) {
    SCOPED_TRACE(kind.name);
    Report report;
    const TetMesh mesh = split(meshes::quadraticBlock(kind, 2).finish(same, number), &report);
    EXPECT_TRUE(report.warnings.empty());
    EXPECT_NEAR(volumeOf(mesh), kind.type == CellType::Tetra ? 8.0 / 6 : 8, 1e-13);
    const std::size_t cells = mesh.curved.cells.size();
    EXPECT_EQ(mesh.cellCount, cells);
    EXPECT_EQ(mesh.tetCount(), cells * tetsOf(*curvedShape(kind.type, kind.nodes())));
  }
}

// A block's surface is 6 x 2 x 2 squares, each of 4 squares of two triangles (pyramids' and
// hexahedra's faces too).
TEST(CutQuadratic, NeighboursAgree) {
  for (const auto& kind : meshes::quadraticKinds()) {
    if (kind.type == CellType::Tetra)
      continue; // they do not fill the block
    SCOPED_TRACE(kind.name);
    const TetMesh mesh = split(meshes::quadraticBlock(kind, 2).finish(bent, number));
    EXPECT_EQ(meshes::openFaces(mesh), 6u * 4 * 4 * 2);
  }
}

// Hexahedra, and pyramids on the far side of a face, both without nodes in it.
TEST(CutQuadratic, NeighboursOfOtherTypesAgree) {
  const auto kinds = meshes::quadraticKinds();
  meshes::QuadraticMesh two = meshes::quadraticBlock(kinds[1], 1);
  two.add(kinds[5], [](const Vec3d& p) { return Vec3d{p[0], p[1], 1 + p[2]}; });
  two.add(kinds[3], [](const Vec3d& p) { return Vec3d{1 + p[0], p[2], p[1]}; });
  const TetMesh mesh = split(two.finish(bent, number));
  // Of a cube 4 faces, of a pyramid 4 triangles, of a wedge 2 squares and 2 triangles; a triangle
  // is cut into 4.
  EXPECT_EQ(meshes::openFaces(mesh), 4u * 8 + 4 * 4 + 2 * 8 + 2 * 4);
}

// Each corner of a tet is where the cell's shape functions have its place.
TEST(CutQuadratic, PlacesAreThoseOfTheShapeFunctions) {
  for (const auto& kind : meshes::quadraticKinds()) {
    SCOPED_TRACE(kind.name);
    const TetMesh mesh = split(meshes::quadraticBlock(kind, 2).finish(bent, number));
    for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
      const CurvedCells::Cell& cell = mesh.curved.cells[mesh.curved.cellOfTet[t]];
      for (std::size_t i = 0; i < 4; ++i) {
        double weights[kMaxCurvedNodes];
        shapeFunctions(cell.shape, placeOf(cell.shape, mesh.curved.corners[t][i]), weights);
        for (std::size_t k = 0; k < 3; ++k) {
          double at = 0;
          for (std::size_t n = 0; n < nodeCount(cell.shape); ++n)
            at += weights[n] * mesh.points[mesh.curved.nodes[cell.first + n]][k];
          ASSERT_NEAR(at, mesh.points[mesh.tets[4 * t + i]][k], 1e-7);
        }
      }
    }
  }
}

// Points that were added have values: of a field that is linear in space its own, since the middle
// of a face is one sum of its nodes for both.
TEST(CutQuadratic, AddedPointsHaveValues) {
  for (const auto& kind : meshes::quadraticKinds()) {
    SCOPED_TRACE(kind.name);
    CellMesh cells = meshes::quadraticBlock(kind, 2).finish(bent, number);
    std::vector<std::int32_t> label(cells.points.size(), 7);
    cells.attributes.push_back({"label", Attribute::On::Points, 1, std::move(label)});
    const TetMesh mesh = split(std::move(cells));
    ASSERT_EQ(mesh.attributes[0].size(), mesh.points.size());
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      EXPECT_NEAR(mesh.attributes[0].number(i), number(mesh.points[i]), 1e-13);
      EXPECT_EQ(mesh.attributes[1].number(i), 7);
    }
  }
}

// Curved cells of a ball hold more of it than their corners do.
TEST(CutQuadratic, CurvedCellsFollowABall) {
  for (const auto& kind : meshes::quadraticKinds()) {
    if (kind.type == CellType::Tetra)
      continue;
    SCOPED_TRACE(kind.name);
    const auto onBall = [](const Vec3d& p) {
      const Vec3d q{p[0] - 1, p[1] - 1, p[2] - 1};
      const double maxValue = std::max({std::abs(q[0]), std::abs(q[1]), std::abs(q[2])});
      const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
      if (length == 0)
        return q;
      return Vec3d{q[0] * maxValue / length, q[1] * maxValue / length, q[2] * maxValue / length};
    };
    const double volume = volumeOf(split(meshes::quadraticBlock(kind, 2).finish(onBall, number)));
    const double ball = 4 * 3.14159265358979 / 3;
    EXPECT_GT(volume, 0.9 * ball);
    EXPECT_LT(volume, ball);
  }
}

} // namespace
