// SPDX-License-Identifier: Apache-2.0
//
// Every tet file of the corpus, against the values that tet_oracle.py finds with other readers. The
// folder that holds tet/ is named by the environment variable TETVDB_CORPUS.
#include "ExpectedFiles.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/mesh/SplitPolyhedron.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <istream>
#include <map>
#include <string>
#include <vector>

namespace tetvdb {
namespace {

struct Expected {
  std::string file, status;
  std::string tetra, hexahedron, wedge, pyramid; ///< numbers of cells, "-" for errors
  std::string volume, signedVolume, plane;
};

std::istream& operator>>(std::istream& in, Expected& e) {
  return in >> e.file >> e.status >> e.tetra >> e.hexahedron >> e.wedge >> e.pyramid >> e.volume >>
         e.signedVolume >> e.plane;
}

// Curved faces of hexahedra and wedges bulge differently by the diagonal that cuts them: up to a
// fiftieth of the volume in the coarse cells of the corpus.
constexpr double kPlaneTolerance = 1e-9;
constexpr double kBulgeTolerance = 2e-2;

// Keeps only the corners of quadratic cells.
void keepCorners(CellMesh& mesh) {
  std::vector<std::uint32_t> kept;
  const std::uint32_t* nodes = mesh.nodes.data();
  for (CellRun& run : mesh.runs) {
    const std::uint32_t each = run.nodesPerCell;
    const std::uint32_t corners = run.type == CellType::Tetra        ? 4
                                  : run.type == CellType::Hexahedron ? 8
                                  : run.type == CellType::Wedge      ? 6
                                  : run.type == CellType::Pyramid    ? 5
                                                                     : each;
    for (std::size_t i = 0; i < run.count; ++i, nodes += each)
      kept.insert(kept.end(), nodes, nodes + std::min(corners, each));
    run.nodesPerCell = std::min(corners, each);
  }
  mesh.nodes = std::move(kept);
}

void compare(const Expected& expected, const std::string& path) {
  Report report;
  Progress progress;
  CellMesh cells;
  try {
    cells = readCells(path, {}, report, progress);
  } catch (const Error& error) {
    EXPECT_EQ(expected.status, "error") << error.what();
    EXPECT_EQ(error.status(), Status::Invalid) << error.what();
    EXPECT_EQ(std::string(error.what()).find(path.substr(0, path.size() - 5)), 0U) << error.what();
    return;
  }
  ASSERT_EQ(expected.status, "mesh");
  std::map<CellType, std::size_t> counts;
  for (const CellRun& run : cells.runs)
    counts[run.type] += run.count;
  EXPECT_EQ(std::to_string(counts[CellType::Tetra]), expected.tetra);
  EXPECT_EQ(std::to_string(counts[CellType::Hexahedron] + counts[CellType::Voxel]),
            expected.hexahedron);
  EXPECT_EQ(std::to_string(counts[CellType::Wedge]), expected.wedge);
  EXPECT_EQ(std::to_string(counts[CellType::Pyramid]), expected.pyramid);
  keepCorners(cells); // the oracle ignores the other nodes
  const TetMesh mesh = splitCells(std::move(cells), {}, report, progress);
  double volume = 0;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    const std::uint32_t* n = mesh.tets.data() + 4 * t;
    volume += std::abs(sixfoldVolume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]],
                                     mesh.points[n[3]])) /
              6;
  }
  const bool plane = expected.plane == "yes";
  // A cell turned inside out in places sums its tets up differently still.
  bool concave = false;
  for (const Warning& warning : report.warnings)
    concave = concave || warning.code == "concave-cells";
  const double wanted = std::stod(expected.volume);
  const double tolerance = plane ? kPlaneTolerance : concave ? 0.1 : kBulgeTolerance;
  EXPECT_NEAR(volume, wanted, tolerance * wanted);
  EXPECT_FALSE(report.partial);
}

TEST(TetCorpus, EveryFileIsReadOrRefused) {
  test::forEachExpected<Expected>("tet_expected.tsv", "tet", 44, compare);
}

} // namespace
} // namespace tetvdb
