// SPDX-License-Identifier: Apache-2.0
#include "io/VtkTestMesh.h"
#include "tetvdb/io/formats/vtk/VtuReader.h"
#include "tetvdb/io/formats/vtk/VtuWriter.h"

#include <unistd.h>

namespace tetvdb::test {
namespace {

TetMesh twoCellsThreeTets() {
  TetMesh mesh;
  mesh.points = expectedPoints();
  mesh.points[3][1] = 1.0 / 3;
  mesh.tets = {0, 1, 2, 5, 8, 11, 12, 13, 8, 11, 12, 9};
  mesh.cellOfTet = {1, 0, 0};
  mesh.cellCount = 2;
  mesh.regions = {7, -9};
  const std::size_t n = mesh.points.size();
  std::vector<double> vectors(3 * n);
  for (std::size_t i = 0; i < vectors.size(); ++i)
    vectors[i] = 0.1 * static_cast<double>(i);
  mesh.attributes.push_back({"a <\"b\"> & c", Attribute::On::Points, 3, vectors});
  mesh.attributes.push_back({"p", Attribute::On::Points, 1, std::vector<float>(n, 0.5f)});
  mesh.attributes.push_back({"q", Attribute::On::Cells, 2, std::vector<std::int64_t>{1, 2, 3, 4}});
  mesh.attributes.push_back({"r", Attribute::On::Cells, 1, std::vector<std::int32_t>{-5, 6}});
  return mesh;
}

} // namespace

TEST(VtuWriter, ReadsBackTheSame) {
  const std::string path =
      ::testing::TempDir() + "tetvdb_writer_" + std::to_string(getpid()) + ".vtu";
  const TetMesh mesh = twoCellsThreeTets();
  Progress progress;
  writeVtu(path, mesh, progress);
  Report report;
  const CellMesh back = read(readVtu, fileBytes(path), report, path);
  std::filesystem::remove(path);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(back.points, mesh.points);
  EXPECT_EQ(back.nodes, mesh.tets);
  ASSERT_EQ(back.attributes.size(), 5u);
  EXPECT_EQ(back.attributes[0].name, mesh.attributes[0].name);
  EXPECT_EQ(back.attributes[0].values, mesh.attributes[0].values);
  EXPECT_EQ(back.attributes[1].values, mesh.attributes[1].values);
  EXPECT_EQ(back.attributes[2].values,
            Attribute::Values(std::vector<std::int64_t>{3, 4, 1, 2, 1, 2}));
  EXPECT_EQ(back.attributes[3].values, Attribute::Values(std::vector<std::int32_t>{6, -5, -5}));
  EXPECT_EQ(back.attributes[4].name, "region");
  EXPECT_EQ(back.attributes[4].values, Attribute::Values(std::vector<std::int32_t>{-9, 7, 7}));
}

TEST(VtuWriter, CancelledLeavesNothing) {
  const std::string path =
      ::testing::TempDir() + "tetvdb_cancel_" + std::to_string(getpid()) + ".vtu";
  Progress progress;
  progress.cancel();
  EXPECT_THROW(writeVtu(path, twoCellsThreeTets(), progress), Error);
  EXPECT_FALSE(std::filesystem::exists(path));
}

} // namespace tetvdb::test
