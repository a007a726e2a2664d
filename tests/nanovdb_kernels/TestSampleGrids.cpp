// SPDX-License-Identifier: Apache-2.0
#include "FieldCases.h"
#include "nanovdb_kernels/AnySoup.h"
#include "tetvdb/core/NanoVdb.h"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace {

using namespace tetvdb;
using meshes::kuhnGrid;

SampledFields twinGrids(const TetMesh& mesh, const GridTransform& transform,
                        const FieldOptions& wanted, CollectedGrids& collected) {
  return nanoFieldsBy(
      mesh, transform, wanted, collected,
      [](const nano::MeshView& view, const nano::FieldJob& job, nano::GridReceiver& receiver) {
        nano::HostTwin().sampleGrids(view, job, receiver);
      });
}

std::vector<NanoBytes> expectSameGrids(const TetMesh& bare, const GridTransform& transform = {},
                                       const FieldOptions& wanted = allFields()) {
  const TetMesh mesh = bare.attributes.empty() ? withArrays(bare, 5) : bare;
  CollectedGrids collected;
  const SampledFields twin = twinGrids(mesh, transform, wanted, collected);
  const SampledFields cpu = cpuFields(mesh, transform, wanted);
  EXPECT_EQ(twin.hash, cpu.hash);
  EXPECT_TRUE(twin.complete);
  EXPECT_EQ(twin.warnings.size(), cpu.warnings.size()); // also how many voxels are left out
  for (std::size_t i = 0; i < std::min(twin.warnings.size(), cpu.warnings.size()); ++i)
    EXPECT_EQ(twin.warnings[i].text, cpu.warnings[i].text);
  return collected.grids;
}

TEST(SampleGrids, LatticeWhereEveryCentreIsATie) {
  for (int cell : {1, 3, 8})
    expectSameGrids(meshes::scaled(kuhnGrid(3, 3, 3), cell));
}

TEST(SampleGrids, NegativeCoordinatesAndAnisotropicVoxels) {
  expectSameGrids(
      meshes::scaled(meshes::jittered(kuhnGrid(3, 4, 5), 0.2, 3), 7.3, {-20.1, -5000.7, 3.3}),
      {{0.9, 1.1, 1.7}, {0.25, -3, 8}});
}

TEST(SampleGrids, OverlapsFlipsAndFlatTets) {
  expectSameGrids(meshes::soup(300, 40, 9, 1, 5));
  expectSameGrids(meshes::rounded(meshes::soup(300, 20, 5, 2, 5), 0.5));
}

TEST(SampleGrids, CellsOfSeveralTets) {
  expectSameGrids(withCellsOfSix(meshes::scaled(meshes::jittered(kuhnGrid(3, 3, 3), 0.2, 9), 6)));
}

TEST(SampleGrids, NothingInside) {
  expectSameGrids(meshes::scaled(kuhnGrid(1, 1, 1), 0.1, {0.5, 0.5, 0.5}));
}

// A tet that holds the node at the origin, and another.
TetMesh tetsThatFillNodes() {
  TetMesh mesh;
  mesh.points = {{-1, -1, -1}, {395, -1, -1}, {-1, 395, -1}, {-1, -1, 395}, {150, 150, 150}};
  mesh.tets = {0, 1, 2, 3, 1, 2, 3, 4};
  mesh.cellCount = 2;
  return mesh;
}

// In the nodes of a level above the lowest.
std::uint32_t tilesAt(const NanoBytes& grid, int level) {
  return reinterpret_cast<const nanovdb::NanoGrid<float>*>(grid.data.get())
      ->tree()
      .data()
      ->mTileCount[level];
}

// Tiles of leaves and nodes where a value is all there is, and nothing where there is none. Zeros
// of both signs are one value.
TEST(SampleGrids, TilesOfOneValue) {
  TetMesh mesh = tetsThatFillNodes();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto onCells = [&](const char* name, double a, double b) {
    mesh.attributes.push_back({name, Attribute::On::Cells, 1, std::vector<double>{a, b}});
  };
  mesh.attributes.push_back(
      {"constant", Attribute::On::Points, 1, std::vector<float>(mesh.points.size(), 7)});
  onCells("cells", -3, 4);
  onCells("hollow", nan, 4);
  onCells("minus", -0.0, 4);
  mesh.attributes.push_back({"kinds", Attribute::On::Cells, 1, std::vector<std::int32_t>{-5, 2}});
  const auto vectors = [&](const char* name, const std::vector<float>& ofCells) {
    mesh.attributes.push_back({name, Attribute::On::Cells, 3, ofCells});
  };
  vectors("still", {1, 2, 3, 1, 2, 3});
  vectors("apart", {1, 2, 3, 1, 2, 4});
  vectors("zero", {0, -0.0F, 0, -0.0F, 0, 0});
  vectors("torn", {1, std::numeric_limits<float>::infinity(), 3, 1, 2, 4});
  FieldOptions wanted;
  wanted.all = true;
  const auto made = expectSameGrids(mesh, {}, wanted);
  for (const std::size_t i : {0u, 1u, 3u, 4u, 5u, 6u, 7u})
    EXPECT_GT(tilesAt(made[i], 1), 0u);
  for (const std::size_t i : {2u, 8u})
    EXPECT_EQ(tilesAt(made[i], 1), 0u);
  // Zeros of either sign on all sides of a voxel.
  TetMesh zeros = meshes::scaled(kuhnGrid(40, 40, 40), 1, {0.25, 0.25, 0.25});
  std::vector<float> values(zeros.tetCount());
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = i % 7 == 0 ? 0.0F : -0.0F;
  zeros.cellCount = zeros.tetCount();
  zeros.attributes.push_back({"zeros", Attribute::On::Cells, 1, values});
  std::vector<float> vectorsOfCells;
  for (const float v : values)
    vectorsOfCells.insert(vectorsOfCells.end(), {2, v, -v});
  zeros.attributes.push_back({"vectors", Attribute::On::Cells, 3, vectorsOfCells});
  for (const NanoBytes& grid : expectSameGrids(zeros, {}, wanted))
    EXPECT_GT(tilesAt(grid, 0), 0u);
}

// What NanoVDB's statistics are of.
double statistic(float v) {
  return static_cast<double>(v);
}
double statistic(std::int32_t v) {
  return v;
}
double statistic(const nanovdb::Vec3f& v) {
  return static_cast<double>(v.lengthSqr());
}

// What a node says of its active values, against sums over all of them.
template <typename Node, typename Value>
void expectStatistics(const Node& node, const std::vector<Value>& active) {
  double sum = 0, squares = 0;
  for (const Value& v : active)
    sum += statistic(v);
  const double mean = sum / static_cast<double>(active.size());
  for (const Value& v : active)
    squares += (statistic(v) - mean) * (statistic(v) - mean);
  const double deviation = std::sqrt(squares / static_cast<double>(active.size()));
  const double scale = std::abs(mean) + deviation + 1e-30;
  const auto less = [](const Value& a, const Value& b) { return statistic(a) < statistic(b); };
  const auto bounds = std::minmax_element(active.begin(), active.end(), less);
  const Value low = node.mMinimum, high = node.mMaximum;
  EXPECT_EQ(statistic(low), statistic(*bounds.first));
  EXPECT_EQ(statistic(high), statistic(*bounds.second));
  EXPECT_NE(std::find(active.begin(), active.end(), low), active.end());
  EXPECT_NE(std::find(active.begin(), active.end(), high), active.end());
  EXPECT_NEAR(static_cast<double>(node.mAverage), mean, 1e-6 * scale);
  EXPECT_NEAR(static_cast<double>(node.mStdDevi), deviation, 1e-6 * scale);
}

template <typename Value>
void expectStatisticsOf(const NanoBytes& bytes) {
  const auto& grid = *reinterpret_cast<const nanovdb::NanoGrid<Value>*>(bytes.data.get());
  const auto& tree = grid.tree();
  std::vector<Value> all;
  for (std::uint32_t i = 0; i < tree.nodeCount(0); ++i) {
    const auto& leaf = *(tree.template getFirstNode<0>() + i);
    std::vector<Value> active;
    for (std::uint32_t n = 0; n < 512; ++n)
      if (leaf.isActive(n))
        active.push_back(leaf.getValue(n));
    expectStatistics(*leaf.data(), active);
    all.insert(all.end(), active.begin(), active.end());
  }
  for (std::uint32_t i = 0; i < tree.nodeCount(1); ++i) {
    const auto& lower = *(tree.template getFirstNode<1>() + i);
    for (std::uint32_t n = 0; n < 4096; ++n)
      if (!lower.data()->mChildMask.isOn(n) && lower.data()->mValueMask.isOn(n))
        all.insert(all.end(), 512, lower.data()->getValue(n));
  }
  ASSERT_EQ(tree.nodeCount(2), 1u);
  expectStatistics(*tree.root().data(), all);
  EXPECT_EQ(tree.activeVoxelCount(), all.size());
}

TEST(SampleGrids, StatisticsAreThoseOfTheActiveValues) {
  const TetMesh mesh =
      withArrays(meshes::scaled(meshes::jittered(kuhnGrid(3, 3, 3), 0.2, 4), 13), 8);
  FieldOptions wanted;
  wanted.requests = {
      {"", "temperature", FieldPart::Whole, ""}, {"", "holes", FieldPart::Whole, ""},
      {"", "patches", FieldPart::Whole, ""},     {"", "label", FieldPart::Whole, ""},
      {"", "vel", FieldPart::Whole, ""},         {"", "force", FieldPart::Whole, ""}};
  const auto grids = expectSameGrids(mesh, {}, wanted);
  for (std::size_t i = 0; i < 3; ++i)
    expectStatisticsOf<float>(grids[i]);
  expectStatisticsOf<std::int32_t>(grids[3]);
  for (std::size_t i = 4; i < 6; ++i)
    expectStatisticsOf<nanovdb::Vec3f>(grids[i]);
}

RC_GTEST_PROP(SampleGridsProperties, Soups, ()) {
  expectSameGrids(meshes::anySoup());
}

} // namespace
