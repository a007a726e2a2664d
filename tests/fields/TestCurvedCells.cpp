// SPDX-License-Identifier: Apache-2.0
//
// Values in quadratic cells of all shapes are those of their own shape functions.
#include "QuadraticMesh.h"
#include "tetvdb/fields/SampleFields.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/volume/Grids.h"

#include <cmath>
#include <gtest/gtest.h>

namespace {

using namespace tetvdb;

openvdb::FloatGrid::Ptr sample(CellMesh cells) {
  Report report;
  Progress progress;
  const TetMesh mesh = splitCells(std::move(cells), {}, report, progress);
  FieldOptions options;
  options.requests = {{"", "f", FieldPart::Whole, ""}};
  const GridTransform transform{{0.05, 0.05, 0.05}, {0.013, 0.007, 0.021}};
  Volume volume;
  sampleFields(mesh, transform, resolveFields(mesh, options, report), {}, volume, report, progress);
  return openvdb::gridPtrCast<openvdb::FloatGrid>(volume.grids().all[0]);
}

// The largest difference from f, and how many voxels there are.
template <typename F>
double worst(const openvdb::FloatGrid& grid, const F& f, std::size_t min) {
  std::size_t count = 0;
  double max = 0;
  for (auto it = grid.cbeginValueOn(); it; ++it, ++count) {
    const openvdb::Vec3d p = grid.indexToWorld(it.getCoord());
    max = std::max(max, std::abs(*it - f(Vec3d{p[0], p[1], p[2]})));
  }
  EXPECT_GE(count, min);
  return max;
}

double quadratic(const Vec3d& p) {
  return 3 + p[0] * p[0] - 2 * p[1] * p[2] + 0.5 * p[2] * p[2] - p[0];
}
double linear(const Vec3d& p) {
  return 2 * p[0] - p[1] + 3 * p[2];
}
// Parallelepipeds of cubes.
Vec3d sheared(const Vec3d& p) {
  return {p[0] + 0.3 * p[1], p[1] - 0.2 * p[2], p[2] + 0.1 * p[0]};
}
// Edges stay straight, faces become hyperbolic.
Vec3d twisted(const Vec3d& p) {
  return {p[0] + 0.08 * p[1] * p[2], p[1] + 0.06 * p[0] * p[2], p[2] - 0.05 * p[0] * p[1]};
}
Vec3d bent(const Vec3d& p) {
  return {p[0] + 0.1 * p[1] * p[1], p[1] - 0.07 * p[2] * p[2], p[2] + 0.05 * p[0] * p[1]};
}

constexpr double kRounding = 3e-6; // of floats up to about 20
constexpr std::size_t kSome = 9000;

TEST(CurvedCells, QuadraticFieldsInAffineCells) {
  for (const auto& kind : meshes::quadraticKinds()) {
    SCOPED_TRACE(kind.name);
    const auto grid = sample(meshes::quadraticBlock(kind, 2).finish(sheared, quadratic));
    EXPECT_LT(worst(*grid, quadratic, kSome), kRounding);
  }
}

// Wherever a cell maps its reference cell by its own shape functions, a field that is linear in
// space is reproduced, however curved the cell.
TEST(CurvedCells, LinearFieldsInCurvedCells) {
  for (const auto& kind : meshes::quadraticKinds()) {
    SCOPED_TRACE(kind.name);
    const auto grid = sample(meshes::quadraticBlock(kind, 2).finish(bent, linear));
    EXPECT_LT(worst(*grid, linear, kSome), kRounding);
  }
}

// Tensor products hold squares of trilinear maps.
TEST(CurvedCells, QuadraticFieldsInTwistedHexahedra) {
  const auto kinds = meshes::quadraticKinds();
  const auto grid = sample(meshes::quadraticBlock(kinds[2], 2).finish(twisted, quadratic));
  EXPECT_LT(worst(*grid, quadratic, kSome), kRounding);
}

// One curved cell, its map and its field said by polynomials of the reference cell and solved for
// by bisection: nothing of the library's functions.
TEST(CurvedCells, OneHexahedronByAnotherWay) {
  const auto kinds = meshes::quadraticKinds();
  // x and y are bent by z alone, so that the place is found axis by axis.
  const auto place = [](const Vec3d& p) {
    return Vec3d{p[0] + 0.3 * p[2] * p[2], p[1] - 0.2 * p[2], p[2] * (1 + 0.2 * p[2])};
  };
  const auto reference = [](const Vec3d& p) {
    double low = -0.5, high = 1.5;
    for (int i = 0; i < 80; ++i) {
      const double z = (low + high) / 2;
      (z * (1 + 0.2 * z) < p[2] ? low : high) = z;
    }
    return Vec3d{p[0] - 0.3 * low * low, p[1] + 0.2 * low, low};
  };
  const auto ofReference = [](const Vec3d& q) { return q[0] * q[1] - 2 * q[2] * q[2] + q[0]; };
  for (const std::size_t k : {1u, 2u}) {
    SCOPED_TRACE(kinds[k].name);
    const auto f = [&](const Vec3d& p) { return ofReference(reference(p)); };
    const auto grid = sample(meshes::quadraticBlock(kinds[k], 1).finish(place, f));
    EXPECT_LT(worst(*grid, f, 5000), kRounding);
  }
}

TEST(CurvedCells, ConstantsStayConstant) {
  for (const auto& kind : meshes::quadraticKinds()) {
    const auto grid =
        sample(meshes::quadraticBlock(kind, 2).finish(bent, [](const Vec3d&) { return 0.1; }));
    for (auto it = grid->cbeginValueOn(); it; ++it)
      ASSERT_EQ(*it, 0.1f) << kind.name;
  }
}

} // namespace
