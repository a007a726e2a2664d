// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "tetvdb/io/formats/netgen/NetgenReader.h"

namespace tetvdb {
namespace {

using namespace test;

TEST(NetgenReader, TetsMaterialsAndNames) {
  const CellMesh mesh = readText(readNetgen, kNetgen);
  EXPECT_NEAR(cellVolume(mesh), 0.5, 1e-15);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{0, 1, 2, 0}));
  EXPECT_EQ(mesh.regionNames.at(1), "inner part");
  ASSERT_EQ(mesh.runs.size(), 4U);
  EXPECT_TRUE(mesh.runs[2].quadratic);
}

TEST(NetgenReader, OtherSolids) {
  const std::string points = "points\n8\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n";
  const auto volume = [&](const std::string& element) {
    return cellVolume(
        readText(readNetgen, "mesh3d\nvolumeelements\n1\n" + element + "\n" + points + "endmesh"));
  };
  EXPECT_NEAR(volume("1 8 1 4 3 2 5 8 7 6"), 1, 1e-15);
  EXPECT_NEAR(volume("1 6 1 4 2 5 8 6"), 0.5, 1e-15);
  EXPECT_NEAR(volume("1 5 1 4 3 2 5"), 1.0 / 3, 1e-15);
}

TEST(NetgenReader, ErrorsSayWhere) {
  const auto error = [](const std::string& from, const std::string& to) {
    std::string text = kNetgen;
    return readingError(readNetgen, text.replace(text.find(from), from.size(), to));
  };
  EXPECT_NE(error("1 4 1 2 3 4", "1 7 1 2 3 4").find("file:16: a volume element of 7 nodes"),
            std::string::npos);
  EXPECT_NE(error("1 4 1 2 3 4", "1 4 1 2 3 6").find("point 6 of 5"), std::string::npos);
  EXPECT_NE(error("dimension\n3", "dimension\n2").find("three-dimensional"), std::string::npos);
  EXPECT_NE(error("volumeelements\n2", "volumeelements\n2000").find("file holds"),
            std::string::npos);
  EXPECT_NE(error("0 1 0\n0 0 1e0", "0 1 0\n0 x 1e0").find("'x'"), std::string::npos);
}

} // namespace
} // namespace tetvdb
