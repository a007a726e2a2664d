// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/StructuredBlock.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb::test {
namespace {

/// Integer positions, after `before` other points.
CellMesh lattice(const BlockSize& size, std::size_t before, bool faces) {
  CellMesh mesh;
  mesh.points.assign(before, Vec3d{-9, -9, -9});
  for (std::size_t k = 0; k < size[2]; ++k)
    for (std::size_t j = 0; j < size[1]; ++j)
      for (std::size_t i = 0; i < size[0]; ++i)
        mesh.points.push_back({double(i), double(j), double(k)});
  EXPECT_EQ(appendBlock(mesh, size, before, faces), blockCells(size));
  EXPECT_EQ(mesh.cellCount(), blockCells(size));
  return mesh;
}

} // namespace

TEST(StructuredBlock, HexahedraAreUnitCubesInTheOrderOfTheirFirstPoints) {
  const BlockSize size = {4, 3, 2};
  const CellMesh mesh = lattice(size, 5, false);
  ASSERT_EQ(mesh.runs.size(), 1u);
  EXPECT_EQ(mesh.runs[0].type, CellType::Hexahedron);
  ASSERT_EQ(mesh.nodes.size(), 8u * 6);
  static constexpr double kCorners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                            {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  for (std::size_t cell = 0; cell < 6; ++cell)
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const Vec3d& p = mesh.points[mesh.nodes[8 * cell + corner]];
      EXPECT_EQ(p[0], double(cell % 3) + kCorners[corner][0]) << cell << " " << corner;
      EXPECT_EQ(p[1], double(cell / 3) + kCorners[corner][1]) << cell << " " << corner;
      EXPECT_EQ(p[2], kCorners[corner][2]) << cell << " " << corner;
    }
}

TEST(StructuredBlock, ASinglePointAlongAnAxisLeavesQuadrilaterals) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    BlockSize size = {3, 3, 3};
    size[axis] = 1;
    const CellMesh counted = lattice(size, 0, false);
    ASSERT_EQ(counted.runs.size(), 1u);
    EXPECT_EQ(counted.runs[0].type, CellType::Flat);
    EXPECT_TRUE(counted.nodes.empty());
    const CellMesh mesh = lattice(size, 2, true);
    ASSERT_EQ(mesh.runs.size(), 1u);
    EXPECT_EQ(mesh.runs[0].nodesPerCell, 4u);
    ASSERT_EQ(mesh.nodes.size(), 4u * 4);
    for (std::size_t cell = 0; cell < 4; ++cell) {
      Vec3d diagonal{}; // both are of one length, and the corners go around
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const Vec3d& a = mesh.points[mesh.nodes[4 * cell + corner]];
        const Vec3d& b = mesh.points[mesh.nodes[4 * cell + (corner + 1) % 4]];
        double length = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          length += std::abs(a[k] - b[k]);
          diagonal[k] += a[k];
        }
        EXPECT_EQ(length, 1);
      }
      EXPECT_EQ(diagonal[axis], 0);
    }
  }
}

TEST(StructuredBlock, LinesAndVerticesAreCounted) {
  EXPECT_EQ(lattice({1, 5, 1}, 0, true).cellCount(), 4u);
  EXPECT_EQ(lattice({1, 1, 1}, 0, true).cellCount(), 1u);
  EXPECT_EQ(blockCells({0, 5, 5}), 0u);
  EXPECT_TRUE(lattice({0, 5, 5}, 0, true).runs.empty());
  EXPECT_FALSE(isSolidBlock({1, 5, 5}));
  EXPECT_TRUE(isSolidBlock({2, 2, 2}));
}

TEST(StructuredBlock, MorePointsThanAFileCanHoldAreRefused) {
  const std::size_t big = std::size_t(1) << 40;
  EXPECT_THROW(blockPoints({big, big, big}, SIZE_MAX, "f"), Error); // no overflow
  EXPECT_THROW(blockPoints({2000, 2000, 2000}, SIZE_MAX, "f"), Error);
  EXPECT_THROW(blockPoints({10, 10, 10}, 999, "f"), Error);
  EXPECT_EQ(blockPoints({10, 10, 10}, 1000, "f"), 1000u);
  const std::vector<double> many(1000, 0.5);
  EXPECT_THROW(rectilinearPoints({many, many, many}, 24000, "f"), Error);
  EXPECT_EQ(rectilinearPoints({many, many, {0}}, 24000, "f").size(), 1000000u);
  EXPECT_THROW(rectilinearPoints({std::vector<double>{0, NAN}, {0}, {0}}, 100, "f"), Error);
}

TEST(StructuredBlock, RectilinearPointsRunAlongXFirst) {
  const auto points = rectilinearPoints({std::vector<double>{1, 2, 4}, {5, 6}, {7, 9}}, 100, "f");
  ASSERT_EQ(points.size(), 12u);
  EXPECT_EQ(points[1], (Vec3d{2, 5, 7}));
  EXPECT_EQ(points[3], (Vec3d{1, 6, 7}));
  EXPECT_EQ(points[11], (Vec3d{4, 6, 9}));
}

} // namespace tetvdb::test
