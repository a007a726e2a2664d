// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/MergeMeshes.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

TetMesh oneTet(double shift) {
  TetMesh mesh;
  mesh.points = {{shift, 0, 0}, {shift + 1, 0, 0}, {shift, 1, 0}, {shift, 0, 1}};
  mesh.tets = {0, 1, 2, 3};
  mesh.cellCount = 1;
  return mesh;
}

TetMesh merge(TetMesh a, TetMesh b, Report& report) {
  std::vector<TetMesh> meshes;
  meshes.push_back(std::move(a));
  meshes.push_back(std::move(b));
  return mergeMeshes(std::move(meshes), report);
}

TEST(MergeMeshes, CornersAndCellsAreNumberedOn) {
  Report report;
  const TetMesh all = merge(oneTet(0), oneTet(5), report);
  EXPECT_EQ(all.points.size(), 8u);
  EXPECT_EQ(all.tets, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(all.cellCount, 2u);
  EXPECT_EQ(all.cell(1), 1u);
  EXPECT_TRUE(report.warnings.empty());
}

TEST(MergeMeshes, CellsThatWereSkippedKeepTheirNumbers) {
  TetMesh a = oneTet(0);
  a.cellCount = 3; // cells 0 and 2 gave no tet
  a.cellOfTet = {1};
  Report report;
  const TetMesh all = merge(a, oneTet(5), report);
  EXPECT_EQ(all.cellCount, 4u);
  EXPECT_EQ(all.cell(0), 1u);
  EXPECT_EQ(all.cell(1), 3u);
}

TEST(MergeMeshes, FilteredCellsWithoutATableAreCountedToo) {
  TetMesh a = oneTet(0);
  a.cellCount = 2; // tet 0 is cell 0, cell 1 gave none
  Report report;
  EXPECT_EQ(merge(a, oneTet(5), report).cell(1), 2u);
}

TEST(MergeMeshes, RegionsOfOneMeshAlone) {
  TetMesh b = oneTet(5);
  b.regions = {7};
  b.regionNames = {{7, "bone"}};
  Report report;
  const TetMesh all = merge(oneTet(0), b, report);
  EXPECT_EQ(all.regions, (std::vector<std::int32_t>{0, 7}));
  EXPECT_EQ(all.regionNames.at(7), "bone");
}

TEST(MergeMeshes, TwoNamesForOneRegionAreReported) {
  TetMesh a = oneTet(0);
  TetMesh b = oneTet(5);
  a.regions = b.regions = {1};
  a.regionNames = {{1, "steel"}};
  b.regionNames = {{1, "air"}};
  Report report;
  EXPECT_EQ(merge(a, b, report).regionNames.at(1), "steel");
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0].code, "region-names");
}

TEST(MergeMeshes, AttributesThatBothHaveStay) {
  TetMesh a = oneTet(0);
  TetMesh b = oneTet(5);
  a.attributes = {{"t", Attribute::On::Cells, 1, std::vector<float>{1.5f}},
                  {"only a", Attribute::On::Cells, 1, std::vector<float>{2.f}}};
  b.attributes = {{"t", Attribute::On::Cells, 1, std::vector<float>{3.5f}}};
  Report report;
  const TetMesh all = merge(a, b, report);
  ASSERT_EQ(all.attributes.size(), 1u);
  EXPECT_EQ(std::get<std::vector<float>>(all.attributes[0].values),
            (std::vector<float>{1.5f, 3.5f}));
}

} // namespace
} // namespace tetvdb
