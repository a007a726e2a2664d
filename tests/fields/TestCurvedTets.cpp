// SPDX-License-Identifier: Apache-2.0
//
// Values in ten-node tets are those of quadraticAt shape functions.
#include "Meshes.h"
#include "Tet10Mesh.h"
#include "tetvdb/fields/SampleFields.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/pipeline/MergeMeshes.h"
#include "tetvdb/volume/Grids.h"

#include <cmath>
#include <gtest/gtest.h>

namespace {

using namespace tetvdb;

// The mesh with the array "f" of f(p).
template <typename Place, typename F>
TetMesh curved(const TetMesh& linear, const Place& place, const F& f) {
  CellMesh cells = meshes::tet10(linear, place);
  std::vector<double> values;
  for (const Vec3d& p : cells.points)
    values.push_back(f(p));
  cells.attributes.push_back({"f", Attribute::On::Points, 1, std::move(values)});
  Report report;
  Progress progress;
  return splitCells(std::move(cells), {}, report, progress);
}

openvdb::FloatGrid::Ptr sample(const TetMesh& mesh, const GridTransform& transform) {
  FieldOptions options;
  options.requests = {{"", "f", FieldPart::Whole, ""}};
  Report report;
  Progress progress;
  Volume volume;
  sampleFields(mesh, transform, resolveFields(mesh, options, report), {}, volume, report, progress);
  return openvdb::gridPtrCast<openvdb::FloatGrid>(volume.grids().all[0]);
}

double quadraticAt(const Vec3d& p) {
  return 3 + p[0] * p[0] - 2 * p[1] * p[2] + 0.5 * p[2] * p[2] - p[0];
}

const GridTransform kTransform{{0.05, 0.05, 0.05}, {0.013, 0.007, 0.021}};

TEST(CurvedTets, QuadraticFieldsAreReproduced) {
  const TetMesh linear = meshes::jittered(meshes::kuhnGrid(2, 2, 2), 0.2, 1);
  const auto grid = sample(curved(
                               linear, [](const Vec3d& p) { return p; }, quadraticAt),
                           kTransform);
  std::size_t count = 0;
  for (auto it = grid->cbeginValueOn(); it; ++it, ++count) {
    const openvdb::Vec3d p = grid->indexToWorld(it.getCoord());
    ASSERT_NEAR(*it, quadraticAt({p[0], p[1], p[2]}), 1e-6) << it.getCoord();
  }
  EXPECT_EQ(count, 40u * 40 * 40);
}

// By the corners alone the same field would be off by far more.
TEST(CurvedTets, LinearInterpolationWouldNotDo) {
  TetMesh linear = meshes::kuhnGrid(2, 2, 2);
  std::vector<double> values;
  for (const Vec3d& p : linear.points)
    values.push_back(quadraticAt(p));
  linear.attributes.push_back({"f", Attribute::On::Points, 1, std::move(values)});
  const auto grid = sample(linear, kTransform);
  double worst = 0;
  for (auto it = grid->cbeginValueOn(); it; ++it) {
    const openvdb::Vec3d p = grid->indexToWorld(it.getCoord());
    worst = std::max(worst, std::abs(*it - quadraticAt({p[0], p[1], p[2]})));
  }
  EXPECT_GT(worst, 0.1);
}

// On curved cells: a field that is linear in space is one at their nodes, and so nearly everywhere.
TEST(CurvedTets, CurvedCells) {
  const auto bend = [](const Vec3d& p) {
    return Vec3d{p[0] + 0.1 * p[1] * p[1], p[1] - 0.07 * p[2] * p[2], p[2]};
  };
  const auto linearField = [](const Vec3d& p) { return 2 * p[0] - p[1] + 3 * p[2]; };
  const auto grid = sample(curved(meshes::kuhnGrid(4, 4, 4), bend, linearField), kTransform);
  ASSERT_GT(grid->activeVoxelCount(), 400000u);
  for (auto it = grid->cbeginValueOn(); it; ++it) {
    const openvdb::Vec3d p = grid->indexToWorld(it.getCoord());
    // A quadraticAt edge is within 0.1 / 8 / 4 of its two chords.
    ASSERT_NEAR(*it, linearField({p[0], p[1], p[2]}), 0.02) << it.getCoord();
  }
}

TEST(CurvedTets, ConstantsStayConstant) {
  const auto grid = sample(curved(
                               meshes::jittered(meshes::kuhnGrid(2, 2, 2), 0.2, 2),
                               [](const Vec3d& p) { return p; }, [](const Vec3d&) { return 0.1; }),
                           kTransform);
  for (auto it = grid->cbeginValueOn(); it; ++it)
    ASSERT_EQ(*it, 0.1f);
}

TEST(CurvedTets, BesideLinearOnes) {
  const auto square = [](const Vec3d& p) { return p[0] * p[0]; };
  std::vector<TetMesh> both;
  both.push_back(meshes::scaled(meshes::kuhnGrid(1, 1, 1), 1, {-1, 0, 0}));
  std::vector<double> values;
  for (const Vec3d& p : both[0].points)
    values.push_back(square(p));
  both[0].attributes.push_back({"f", Attribute::On::Points, 1, std::move(values)});
  both.push_back(curved(
      meshes::kuhnGrid(1, 1, 1), [](const Vec3d& p) { return p; }, square));
  Report report;
  const auto grid = sample(mergeMeshes(std::move(both), report), kTransform);
  EXPECT_EQ(grid->activeVoxelCount(), 40u * 20 * 20);
  for (auto it = grid->cbeginValueOn(); it; ++it) {
    const double x = grid->indexToWorld(it.getCoord())[0];
    ASSERT_NEAR(*it, x < 0 ? -x : x * x, 1e-6) << it.getCoord();
  }
}

} // namespace
