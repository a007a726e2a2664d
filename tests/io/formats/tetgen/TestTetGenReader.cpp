// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "tetvdb/io/formats/tetgen/TetGenReader.h"

#include <cstdio>
#include <unistd.h>

namespace tetvdb {
namespace {

using namespace test;

CellMesh readPair(const std::string& node, const std::string& ele) {
  Report report;
  Progress progress;
  return readTetGenPair(Source{node, "a.node"}, Source{ele, "a.ele"}, {}, report, progress);
}

std::string pairError(const std::string& node, const std::string& ele) {
  try {
    readPair(node, ele);
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Invalid);
    return error.what();
  }
  return {};
}

TEST(TetGenReader, NumbersFromZeroWithAttributesAndMarkers) {
  const CellMesh mesh = readPair(kNode, kEle);
  EXPECT_NEAR(cellVolume(mesh), 0.5, 1e-15);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{7, 8}));
  ASSERT_EQ(mesh.attributes.size(), 3U);
  EXPECT_EQ(mesh.attributes[0].on, Attribute::On::Points);
  EXPECT_EQ(mesh.attributes[0].number(4), 5.5);
  EXPECT_EQ(mesh.attributes[2].name, "attribute2");
  EXPECT_EQ(mesh.attributes[2].number(1), 0.25);
}

TEST(TetGenReader, FromEitherFile) {
  for (const char* name : {"octahedron.node", "octahedron.ele"}) {
    const MappedFile file(dataFile(name));
    Report report;
    Progress progress;
    const CellMesh mesh = readTetGen(file.source(), {}, report, progress);
    EXPECT_NEAR(cellVolume(mesh), 256.0 / 3, 1e-9);
    EXPECT_EQ(mesh.regions.at(0), 100);
  }
}

TEST(TetGenReader, MissingPartnerIsNamed) {
  const std::string path =
      testing::TempDir() + "tetvdb_" + std::to_string(::getpid()) + "_alone.node";
  std::ofstream(path) << kNode;
  const MappedFile file(path);
  Report report;
  Progress progress;
  try {
    readTetGen(file.source(), {}, report, progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("_alone.ele"), std::string::npos) << error.what();
  }
  std::remove(path.c_str());
}

TEST(TetGenReader, ErrorsSayWhichFile) {
  EXPECT_NE(pairError(kNode, "1 4 0\n1 0 1 2 9\n").find("a.ele:2: a tetrahedron uses node 9"),
            std::string::npos);
  EXPECT_NE(pairError(kNode, "1 3 0\n1 0 1 2\n").find("3 nodes"), std::string::npos);
  EXPECT_NE(pairError(kNode, "7 4 0\n1 0 1 2 3\n").find("a.ele:"), std::string::npos);
  EXPECT_NE(pairError("2 2 0 0\n1 0 0\n2 1 1\n", kEle).find("a.node"), std::string::npos);
  EXPECT_NE(pairError("2 3 0 0\n1 0 0 0\n1 1 1 1\n", kEle).find("twice"), std::string::npos);
}

} // namespace
} // namespace tetvdb
