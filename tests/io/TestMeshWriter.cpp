// SPDX-License-Identifier: Apache-2.0
#include "FileBytes.h"
#include "io/MeshSamples.h"
#include "tetvdb/io/MeshWriter.h"

#include <cstdio>
#include <cstring>
#include <limits>
#include <random>
#include <unistd.h>

namespace tetvdb {
namespace {

using namespace test;

TetMesh sample() {
  TetMesh mesh;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1e3, 1e3);
  for (int i = 0; i < 20; ++i)
    mesh.points.push_back({uniform(random), uniform(random) * 1e-200, uniform(random)});
  mesh.points[3] = {-0.0, std::numeric_limits<double>::denorm_min(), 1.0 / 3};
  for (std::uint32_t t = 0; t < 12; ++t)
    for (std::uint32_t k = 0; k < 4; ++k)
      mesh.tets.push_back((5 * t + 3 * k) % 20);
  mesh.cellOfTet = {0, 0, 0, 1, 1, 1, 2, 3, 4, 5, 6, 6};
  mesh.cellCount = 7;
  mesh.regions = {4, 4, 2, 4, 9, 9, 2};
  mesh.regionNames = {{2, "soft"}, {4, "hard \"part\""}};
  std::vector<double> heat(20);
  for (std::size_t i = 0; i < heat.size(); ++i)
    heat[i] = 0.1 * static_cast<double>(i);
  mesh.attributes.push_back({"heat", Attribute::On::Points, 1, heat});
  mesh.attributes.push_back({"velocity", Attribute::On::Cells, 3, std::vector<float>(21, 0.25F)});
  std::get<std::vector<float>>(mesh.attributes[1].values)[20] = 7;
  return mesh;
}

TetMesh writeAndRead(const TetMesh& mesh, const std::string& ending) {
  const std::string path =
      testing::TempDir() + "tetvdb_" + std::to_string(::getpid()) + "_written" + ending;
  Report report;
  Progress progress;
  writeTetMesh(path, mesh, progress);
  TetMesh read = splitCells(readCells(path, {}, report, progress), {}, report, progress);
  EXPECT_TRUE(report.warnings.empty());
  std::remove(path.c_str());
  return read;
}

void expectSameMesh(const TetMesh& read, const TetMesh& mesh) {
  EXPECT_EQ(read.points, mesh.points);
  EXPECT_EQ(read.tets, mesh.tets);
  for (std::size_t t = 0; t < mesh.tetCount(); ++t)
    EXPECT_EQ(read.regions.at(read.cell(t)), mesh.regions.at(mesh.cell(t)));
}

// The file has the tets region by region.
TEST(MeshWriter, GmshReadsBackTheSame) {
  const TetMesh mesh = sample();
  const TetMesh read = writeAndRead(mesh, ".msh");
  std::vector<std::size_t> order; // tets of regions 2, 4, 9
  for (const std::int32_t region : {2, 4, 9})
    for (std::size_t t = 0; t < mesh.tetCount(); ++t)
      if (mesh.regions[mesh.cell(t)] == region)
        order.push_back(t);
  EXPECT_EQ(read.points, mesh.points);
  ASSERT_EQ(read.tetCount(), order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_EQ(read.tets[4 * i + k], mesh.tets[4 * order[i] + k]);
    EXPECT_EQ(read.regions.at(read.cell(i)), mesh.regions.at(mesh.cell(order[i])));
    const double last = mesh.cell(order[i]) == 6 ? 7 : 0.25; // of the cell's velocity
    EXPECT_EQ(read.attributes.at(1).number(read.cell(i), 2), last);
  }
  EXPECT_EQ(read.regionNames.at(2), "soft");
  EXPECT_EQ(read.regionNames.at(4), "hard 'part'");
  ASSERT_EQ(read.attributes.size(), 2U);
  EXPECT_EQ(read.attributes[0].name, "heat");
  EXPECT_EQ(read.attributes[0].number(7), 0.1 * 7);
  EXPECT_EQ(read.attributes[1].on, Attribute::On::Cells);
}

// Programs that show a block each would drown in one for every run of tets.
TEST(MeshWriter, GmshHasABlockARegion) {
  const std::string path =
      testing::TempDir() + "tetvdb_" + std::to_string(::getpid()) + "_blocks.msh";
  Progress progress;
  writeTetMesh(path, sample(), progress);
  const std::string text = test::fileBytes(path);
  const std::size_t at = text.find("$Elements\n") + 10;
  std::uint64_t numbers[4];
  ASSERT_LE(at + sizeof numbers, text.size());
  std::memcpy(numbers, text.data() + at, sizeof numbers);
  EXPECT_EQ(numbers[0], 3U); // regions
  EXPECT_EQ(numbers[1], 12U);
  std::remove(path.c_str());
}

TEST(MeshWriter, MeditReadsBackTheSame) {
  const TetMesh mesh = sample();
  expectSameMesh(writeAndRead(mesh, ".mesh"), mesh);
}

TEST(MeshWriter, GmshFillsUpAndLeavesOut) {
  TetMesh mesh = sample();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> pairs(40, 1.5);
  pairs[0] = pairs[1] = nan;
  mesh.attributes = {{"pairs", Attribute::On::Points, 2, pairs},
                     {"ten", Attribute::On::Points, 10, std::vector<double>(200)}};
  const TetMesh read = writeAndRead(mesh, ".msh");
  ASSERT_EQ(read.attributes.size(), 1U);
  EXPECT_EQ(read.attributes[0].components, 3U);
  EXPECT_TRUE(std::isnan(read.attributes[0].number(0, 0)));
  EXPECT_EQ(read.attributes[0].number(1, 1), 1.5);
  EXPECT_EQ(read.attributes[0].number(1, 2), 0);
}

TEST(MeshWriter, OtherEndingsAndPlacesAreRefused) {
  Progress progress;
  for (const char* path : {"a.stl", "a", "dir.msh/a", ""})
    try {
      writeTetMesh(path, sample(), progress);
      FAIL() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Usage);
    }
  try {
    writeTetMesh("/no/such/folder/a.msh", sample(), progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Write);
  }
}

TEST(MeshWriter, CancelLeavesNothingBehind) {
  const std::string path =
      testing::TempDir() + "tetvdb_" + std::to_string(::getpid()) + "_cancel.msh";
  Progress progress;
  progress.cancel();
  EXPECT_THROW(writeTetMesh(path, sample(), progress), Error);
  EXPECT_NE(::access(path.c_str(), F_OK), 0);
}

} // namespace
} // namespace tetvdb
