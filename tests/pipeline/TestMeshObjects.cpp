// SPDX-License-Identifier: Apache-2.0
#include "TemporaryFolder.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/io/formats/threemf/ThreeMfWriter.h"
#include "tetvdb/pipeline/MeshObjects.h"

#include <filesystem>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;
using namespace tetvdb::meshes;

class MeshObjectsTest : public ::testing::Test {
protected:
  std::string path(const std::string& name) const { return folder_ / name; }

  std::vector<NamedMesh> read(const std::string& name, std::size_t firstAssembly = 0) {
    return readObjects(path(name), firstAssembly, &info_, report_, progress_);
  }

  TemporaryFolder folder_;
  Report report_;
  Progress progress_;
  InputInfo info_;
};

TEST_F(MeshObjectsTest, WhatIsWrittenIsReadAgain) {
  std::vector<NamedMesh> objects;
  objects.push_back({box({0, 0, 0}, {1, 2, 3}), "a <\"b\"> & 'c'", 0, ""});
  objects.push_back({sphere({5, 0, 0}, 1, 3), "ball", 1, "two of them"});
  objects.push_back({box({9, 9, 9}, {10, 11, 12}, 2), "", 1, "two of them"});
  objects.push_back({torus(), "ring", 2, ""});
  for (NamedMesh& object : objects)
    object.mesh.units = "inch";
  writeThreeMf(path("all.3mf"), objects, progress_);
  const std::vector<NamedMesh> again = read("all.3mf", 7);
  ASSERT_EQ(again.size(), objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    EXPECT_EQ(again[i].name, objects[i].name);
    EXPECT_EQ(again[i].mesh.points, objects[i].mesh.points);
    EXPECT_EQ(again[i].mesh.triangles, objects[i].mesh.triangles);
    EXPECT_EQ(again[i].mesh.units, "inch");
    EXPECT_EQ(again[i].assembly, objects[i].assembly + 7);
  }
  EXPECT_EQ(again[1].assemblyName, "two of them");
  EXPECT_EQ(again[2].assemblyName, "two of them");
  EXPECT_EQ(info_.triangles, joinObjects(objects).triangleCount());
  EXPECT_EQ(joinObjects(again).points, joinObjects(objects).points);
  EXPECT_EQ(joinObjects(again).triangles, joinObjects(objects).triangles);
}

TEST_F(MeshObjectsTest, OtherFilesAreOneObjectOfTheirName) {
  writeTriangles(path("lid.v2.stl"), box(), progress_);
  const std::vector<NamedMesh> objects = read("lid.v2.stl", 3);
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_EQ(objects[0].name, "lid.v2");
  EXPECT_EQ(objects[0].assembly, 3u);
  EXPECT_EQ(objects[0].mesh.triangleCount(), 12u);
}

TEST_F(MeshObjectsTest, NothingToWrite) {
  EXPECT_THROW(writeThreeMf(path("none.3mf"), std::vector<NamedMesh>(), progress_), Error);
  EXPECT_FALSE(fs::exists(path("none.3mf")));
}

TEST(MeshObjects, FormatsAndUnits) {
  EXPECT_TRUE(keepsObjects("a/b.3MF"));
  EXPECT_FALSE(keepsObjects("a.3mf/b.stl"));
  std::string name;
  EXPECT_DOUBLE_EQ(metresOf("in", &name), 0.0254);
  EXPECT_EQ(name, "inch");
  EXPECT_DOUBLE_EQ(metresOf("millimetre"), 1e-3);
  EXPECT_EQ(metresOf("parsec"), 0);
}

} // namespace
} // namespace tetvdb
