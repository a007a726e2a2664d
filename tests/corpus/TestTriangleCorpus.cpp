// SPDX-License-Identifier: Apache-2.0
//
// Every triangle file of the corpus, against the values that tri_oracle.py finds with other
// readers. The folder that holds tri/ is named by the environment variable TETVDB_CORPUS.
#include "ExpectedFiles.h"
#include "TriangleMeshes.h"
#include "tetvdb/io/TriangleReader.h"

#include <gtest/gtest.h>
#include <istream>
#include <string>

namespace tetvdb {
namespace {

struct Expected {
  std::string file, status;
  std::string points, triangles, polygons; ///< "-" for errors
  std::string volume, absolute;
};

std::istream& operator>>(std::istream& in, Expected& e) {
  return in >> e.file >> e.status >> e.points >> e.triangles >> e.polygons >> e.volume >>
         e.absolute;
}

void compare(const Expected& expected, const std::string& path) {
  Report report;
  Progress progress;
  TriangleMesh mesh;
  try {
    mesh = readTriangles(path, report, progress);
  } catch (const Error& error) {
    EXPECT_EQ(expected.status, "error") << error.what();
    EXPECT_EQ(error.status(), Status::Invalid) << error.what();
    EXPECT_EQ(std::string(error.what()).find(path), 0U) << error.what();
    return;
  }
  EXPECT_EQ(expected.status, report.partial ? "partial" : "mesh");
  EXPECT_EQ(report.partial, !report.warnings.empty());
  EXPECT_EQ(std::to_string(mesh.points.size()), expected.points);
  EXPECT_EQ(std::to_string(mesh.triangleCount()), expected.triangles);
  EXPECT_EQ(std::to_string(mesh.faceCount), expected.polygons);
  const double tolerance = 1e-12 * std::stod(expected.absolute); // a long sum loses some digits
  EXPECT_NEAR(meshes::signedVolume(mesh), std::stod(expected.volume), tolerance);
}

TEST(TriangleCorpus, EveryFileIsReadOrRefused) {
  test::forEachExpected<Expected>("tri_expected.tsv", "tri", 170, compare);
}

} // namespace
} // namespace tetvdb
