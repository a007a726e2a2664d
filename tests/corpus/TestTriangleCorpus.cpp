// SPDX-License-Identifier: Apache-2.0
//
// Every triangle file of the corpus, against what tri_oracle.py found in it by other means. The
// folder that holds tri/ is named by the environment variable TETVDB_CORPUS.
#include "tetvdb/io/TriangleReader.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <vector>

namespace tetvdb {
namespace {

struct Expected {
  std::string file, status;
  std::string points, triangles, polygons; ///< "-" for errors
  std::string volume, absolute;
};

std::vector<Expected> readExpected() {
  std::ifstream table(std::string(TETVDB_TEST_DATA) + "/../corpus/tri_expected.tsv");
  std::vector<Expected> lines;
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    std::istringstream in(line);
    Expected e;
    in >> e.file >> e.status >> e.points >> e.triangles >> e.polygons >> e.volume >> e.absolute;
    lines.push_back(e);
  }
  return lines;
}

/// The sum of det(a, b, c) / 6 over all triangles.
double signedVolume(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    const Vec3d& a = mesh.points[mesh.triangles[3 * t]];
    const Vec3d& b = mesh.points[mesh.triangles[3 * t + 1]];
    const Vec3d& c = mesh.points[mesh.triangles[3 * t + 2]];
    sum += (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
            a[2] * (b[0] * c[1] - b[1] * c[0])) /
           6;
  }
  return sum;
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
  EXPECT_NEAR(signedVolume(mesh), std::stod(expected.volume), tolerance);
}

TEST(TriangleCorpus, EveryFileIsReadOrRefused) {
  const char* corpus = std::getenv("TETVDB_CORPUS");
  if (corpus == nullptr)
    GTEST_SKIP() << "TETVDB_CORPUS is not set";
  const std::vector<Expected> files = readExpected();
  ASSERT_EQ(files.size(), 170U);
  for (const Expected& expected : files) {
    SCOPED_TRACE(expected.file);
    compare(expected, std::string(corpus) + "/tri/" + expected.file);
  }
}

} // namespace
} // namespace tetvdb
