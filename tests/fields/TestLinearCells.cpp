// SPDX-License-Identifier: Apache-2.0
//
// Values in linear hexahedra, wedges and pyramids are those of VTK's shape functions.
#include "Meshes.h"
#include "QuadraticMesh.h"
#include "tetvdb/fields/SampleFields.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace {

using namespace tetvdb;

struct SampledCells {
  openvdb::FloatGrid::Ptr grid;
  Report report;
};

SampledCells sample(CellMesh cells, const GridTransform& transform) {
  SampledCells result;
  Progress progress;
  const TetMesh mesh = splitCells(std::move(cells), {}, result.report, progress);
  FieldOptions options;
  options.requests = {{"", "f", FieldPart::Whole, ""}};
  Volume volume;
  SampleOptions sampling;
  sampling.allowEmpty = true;
  sampleFields(mesh, transform, resolveFields(mesh, options, result.report), sampling, volume,
               result.report, progress);
  result.grid = openvdb::gridPtrCast<openvdb::FloatGrid>(volume.grids().all[0]);
  return result;
}

bool warns(const Report& report, const std::string& code) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [&](const auto& warning) { return warning.code == code; });
}

// VTK's functions at (r, s, t) in [0, 1]^3, as its manual has them, and the nodes' places.
std::vector<double> functionsOf(CellType type, double r, double s, double t) {
  const double a = 1 - r, b = 1 - s, c = 1 - t;
  switch (type) {
  case CellType::Hexahedron:
    return {a * b * c, r * b * c, r * s * c, a * s * c, a * b * t, r * b * t, r * s * t, a * s * t};
  case CellType::Voxel:
    return {a * b * c, r * b * c, a * s * c, r * s * c, a * b * t, r * b * t, a * s * t, r * s * t};
  case CellType::Wedge:
    return {(1 - r - s) * c, r * c, s * c, (1 - r - s) * t, r * t, s * t};
  default:
    return {a * b * c, r * b * c, r * s * c, a * s * c, t};
  }
}

std::vector<Vec3d> cornersOf(CellType type) {
  switch (type) {
  case CellType::Hexahedron:
    return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  case CellType::Voxel:
    return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
  case CellType::Wedge:
    return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  default:
    return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}};
  }
}

CellMesh oneCell(CellType type, const std::vector<Vec3d>& points, std::vector<double> values) {
  CellMesh mesh;
  mesh.points = points;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    mesh.nodes.push_back(i);
  mesh.runs.push_back({type, static_cast<std::uint32_t>(points.size()), 1, "cell", false});
  mesh.attributes.push_back({"f", Attribute::On::Points, 1, std::move(values)});
  return mesh;
}

// A place in the cell is chosen and mapped, and a voxel's centre put there: nothing is inverted.
void judgePlaces(CellType type, double warp) {
  meshes::Random random(7);
  // Of floats up to 5; places in affine cells are those in snapped tets.
  const double rounding = warp > 0 ? 1e-6 : 5e-6;
  std::size_t judged = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<Vec3d> points = cornersOf(type);
    std::vector<double> values;
    for (Vec3d& p : points) {
      for (double& x : p)
        x = 3 * (x + random.between(-warp, warp)) - 1;
      values.push_back(random.between(-5, 5));
    }
    double r = random.between(0, 1), s = random.between(0, 1);
    const double t = random.between(0, 1);
    if (type == CellType::Wedge && r + s > 1) {
      r = 1 - r;
      s = 1 - s;
    }
    const std::vector<double> n = functionsOf(type, r, s, t);
    Vec3d at{0, 0, 0};
    double expected = 0;
    for (std::size_t i = 0; i < n.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        at[k] += n[i] * points[i][k];
      expected += n[i] * values[i];
    }
    const SampledCells made = sample(oneCell(type, points, values), {{0.3, 0.3, 0.3}, at});
    const openvdb::Coord origin(0, 0, 0);
    if (!made.grid->tree().isValueOn(origin)) // between a warped face and the tets'
      continue;
    ++judged;
    ASSERT_NEAR(made.grid->tree().getValue(origin), expected, rounding) << round;
    EXPECT_FALSE(warns(made.report, "values-by-tets")) << round;
  }
  EXPECT_GT(judged, 250u);
}

TEST(LinearCells, HexahedraAtChosenPlaces) {
  judgePlaces(CellType::Hexahedron, 0.15);
}
TEST(LinearCells, WedgesAtChosenPlaces) {
  judgePlaces(CellType::Wedge, 0.1);
}
TEST(LinearCells, PyramidsAtChosenPlaces) {
  judgePlaces(CellType::Pyramid, 0.1);
}
TEST(LinearCells, VoxelsAtChosenPlaces) {
  judgePlaces(CellType::Voxel, 0);
}
TEST(LinearCells, PyramidsThatAreAffineAtChosenPlaces) {
  judgePlaces(CellType::Pyramid, 0);
}

std::vector<meshes::QuadraticKind> linearKinds() {
  return {{"hexahedron", CellType::Hexahedron, cornersOf(CellType::Hexahedron), {}},
          {"wedge", CellType::Wedge, cornersOf(CellType::Wedge), {}},
          {"pyramid", CellType::Pyramid, cornersOf(CellType::Pyramid), {}}};
}

const GridTransform kFine{{0.05, 0.05, 0.05}, {0.013, 0.007, 0.021}};

Vec3d bentAlongZ(const Vec3d& p) {
  return {p[0] + 0.2 * p[1] * p[1] - 0.1 * p[1] * p[2], p[1] - 0.1 * p[2] * p[2] * p[0],
          p[2] + 0.15 * p[0] * p[1]};
}
// Linear runs: "quadratic" would warn.
CellMesh blockOf(const meshes::QuadraticKind& kind, double (*f)(const Vec3d&)) {
  CellMesh mesh = meshes::quadraticBlock(kind, 2).finish(bentAlongZ, f);
  for (CellRun& run : mesh.runs)
    run.quadratic = false;
  return mesh;
}

// Also where centres lie outside of the warped faces of their cell.
TEST(LinearCells, LinearFieldsAreReproduced) {
  const auto f = [](const Vec3d& p) { return 2 * p[0] - p[1] + 3 * p[2]; };
  for (const auto& kind : linearKinds()) {
    SCOPED_TRACE(kind.name);
    const SampledCells made = sample(blockOf(kind, f), kFine);
    std::size_t count = 0;
    for (auto it = made.grid->cbeginValueOn(); it; ++it, ++count) {
      const openvdb::Vec3d p = made.grid->indexToWorld(it.getCoord());
      ASSERT_NEAR(*it, f({p[0], p[1], p[2]}), 3e-6);
    }
    EXPECT_GT(count, 50000u);
    EXPECT_TRUE(made.report.warnings.empty());
  }
}

TEST(LinearCells, ConstantsStayConstantAndValuesStayInRange) {
  const auto jump = [](const Vec3d& p) {
    return std::sin(40 * (p[0] + 2 * p[1] - p[2])) > 0 ? 1.0 : 0.0;
  };
  for (const auto& kind : linearKinds()) {
    SCOPED_TRACE(kind.name);
    const SampledCells constant = sample(blockOf(kind, [](const Vec3d&) { return 0.1; }), kFine);
    for (auto it = constant.grid->cbeginValueOn(); it; ++it)
      ASSERT_EQ(*it, 0.1f);
    const SampledCells jumping = sample(blockOf(kind, jump), kFine);
    for (auto it = jumping.grid->cbeginValueOn(); it; ++it) {
      ASSERT_GE(*it, -1e-12f); // rounding in doubles
      ASSERT_LE(*it, 1.0f);
    }
  }
}

// A hexahedron whose upper face is a quarter turn and more on: its map folds.
TEST(LinearCells, WhereNoPlaceIsFoundTetsAreTakenAndCounted) {
  std::vector<Vec3d> points = cornersOf(CellType::Hexahedron);
  std::rotate(points.begin() + 4, points.begin() + 6, points.end());
  const auto linear = [](const Vec3d& p) { return 1 + p[0] - 2 * p[1] + p[2]; };
  std::vector<double> values;
  for (const Vec3d& p : points)
    values.push_back(linear(p));
  const SampledCells made = sample(oneCell(CellType::Hexahedron, points, values), kFine);
  EXPECT_TRUE(warns(made.report, "values-by-tets"));
  for (auto it = made.grid->cbeginValueOn(); it; ++it) {
    const openvdb::Vec3d p = made.grid->indexToWorld(it.getCoord());
    ASSERT_NEAR(*it, linear({p[0], p[1], p[2]}), 1e-6);
  }
}

// A wedge as a hexahedron with two edges of no length, as solvers write them.
TEST(LinearCells, CollapsedHexahedra) {
  CellMesh mesh =
      oneCell(CellType::Hexahedron, cornersOf(CellType::Hexahedron), {0, 1, 3, 2, 1, 0, 5, 2});
  mesh.nodes = {0, 1, 2, 2, 4, 5, 6, 6};
  const GridTransform transform{{0.01, 0.01, 0.01}, {0.0031, 0.0017, 0.0043}};
  const SampledCells made = sample(mesh, transform);
  std::size_t count = 0;
  for (auto it = made.grid->cbeginValueOn(); it; ++it, ++count) {
    const openvdb::Vec3d p = made.grid->indexToWorld(it.getCoord());
    // Corners 0, 1, 2 at (0, 0), (1, 0), (1, 1): y = s, x = s + r (1 - s).
    const double s = p[1], r = (p[0] - s) / (1 - s);
    const double below = (1 - r) * (1 - s) * 0 + r * (1 - s) * 1 + s * 3;
    const double above = (1 - r) * (1 - s) * 1 + r * (1 - s) * 0 + s * 5;
    ASSERT_NEAR(*it, below * (1 - p[2]) + above * p[2], 2e-6) << p;
  }
  EXPECT_GT(count, 400000u);
  EXPECT_FALSE(warns(made.report, "values-by-tets"));
}

// The tets, and so the voxels, are those without arrays; shapes are kept where they are asked for.
TEST(LinearCells, OnlyArraysOfPointsKeepCells) {
  CellMesh mesh = oneCell(CellType::Wedge, cornersOf(CellType::Wedge), {0, 1, 2, 3, 4, 5});
  CellMesh bare = mesh;
  bare.attributes.clear();
  Report report;
  Progress progress;
  const TetMesh with = splitCells(std::move(mesh), {}, report, progress);
  const TetMesh without = splitCells(std::move(bare), {}, report, progress);
  EXPECT_EQ(with.tets, without.tets);
  EXPECT_FALSE(with.curved.empty());
  EXPECT_TRUE(without.curved.empty());
}

} // namespace
