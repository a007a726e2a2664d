// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "tetvdb/io/formats/avs/UcdReader.h"

namespace tetvdb {
namespace {

using namespace test;

TEST(UcdReader, TextWithData) {
  const CellMesh mesh = readText(readUcd, kUcd);
  EXPECT_NEAR(cellVolume(mesh), 1 + 1.0 / 3, 1e-15);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{1, 2, 9}));
  ASSERT_EQ(mesh.attributes.size(), 3U);
  EXPECT_EQ(mesh.attributes[0].name, "temperature");
  EXPECT_EQ(mesh.attributes[0].number(8), 10);
  EXPECT_EQ(mesh.attributes[2].components, 2U);
  EXPECT_EQ(mesh.attributes[2].number(1, 1), 4);
  EXPECT_TRUE(std::isnan(mesh.attributes[2].number(2, 1)));
}

TEST(UcdReader, BinaryInBothByteOrders) {
  for (const bool swap : {false, true}) {
    const CellMesh mesh = readText(readUcd, ucdBinary(swap));
    EXPECT_NEAR(cellVolume(mesh), 1 + 1.0 / 3, 1e-15);
    EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{1, 2}));
    ASSERT_EQ(mesh.attributes.size(), 1U);
    EXPECT_EQ(mesh.attributes[0].name, "temperature");
    EXPECT_EQ(mesh.attributes[0].number(8), 9);
  }
}

TEST(UcdReader, ErrorsSayWhere) {
  const auto error = [](const std::string& from, const std::string& to) {
    std::string text = kUcd;
    return readingError(readUcd, text.replace(text.find(from), from.size(), to));
  };
  EXPECT_NE(error("9 3 1 2 0", "900 3 1 2 0").find("file:2"), std::string::npos);
  EXPECT_NE(error("pyr 5", "pyr 6").find("file:12: a cell uses node 6"), std::string::npos);
  EXPECT_NE(error("2 hex", "2 hexa").find("no known kind"), std::string::npos);
  EXPECT_NE(error("8 1 0 -1", "8 1 0 inf").find("finite"), std::string::npos);
  EXPECT_NE(readingError(readUcd, ucdBinary(false).substr(0, 150)).find("file at byte"),
            std::string::npos);
}

} // namespace
} // namespace tetvdb
