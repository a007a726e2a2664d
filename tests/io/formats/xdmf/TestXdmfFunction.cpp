// SPDX-License-Identifier: Apache-2.0
//
// XDMF's finite-element functions: a file of FEniCS's own, and texts laid out like it.
#include "io/MeshSamples.h"
#include "io/XdmfDocument.h"

#include <cmath>

namespace tetvdb::test {
namespace {

CellMesh readCheckpoint(int step, Report& report) {
  ReadOptions options;
  options.timeStep = step;
  Progress progress;
  const std::string path = dataFile("fenics_checkpoint.xdmf");
  return readXdmf({readFile(path), path}, options, report, progress);
}

TEST(XdmfFunction, FenicsCheckpoint) {
  for (const int step : {0, 1}) {
    const double t = 0.5 * step;
    Report report;
    const CellMesh mesh = readCheckpoint(step, report);
    EXPECT_TRUE(report.warnings.empty());
    // Three functions, each with the mesh written again: one mesh.
    ASSERT_EQ(mesh.points.size(), 8u);
    ASSERT_EQ(mesh.cellCount(), 6u);
    const Doubles u = numbers(mesh, "u", kOnPoints), vel = numbers(mesh, "vel", kOnPoints),
                  q = numbers(mesh, "q", kOnCells);
    ASSERT_EQ(u.size(), 8u);
    ASSERT_EQ(vel.size(), 24u);
    ASSERT_EQ(q.size(), 6u);
    for (std::size_t i = 0; i < 8; ++i) {
      const Vec3d& p = mesh.points[i];
      EXPECT_NEAR(u[i], (1 + t) * (2 * p[0] + p[1] - p[2] + 1), 1e-14);
      EXPECT_NEAR(vel[3 * i], p[0], 1e-14);
      EXPECT_NEAR(vel[3 * i + 1], 2 * p[1], 1e-14);
      EXPECT_NEAR(vel[3 * i + 2], 3 * p[2] + t, 1e-14);
    }
    for (std::size_t cell = 0; cell < 6; ++cell) {
      Vec3d midpoint{0, 0, 0};
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t axis = 0; axis < 3; ++axis)
          midpoint[axis] += mesh.points[mesh.nodes[4 * cell + k]][axis] / 4;
      EXPECT_NEAR(q[cell], midpoint[0] + 10 * midpoint[1] + 100 * midpoint[2] + t, 1e-12);
    }
  }
  const std::string path = dataFile("fenics_checkpoint.xdmf");
  EXPECT_EQ(xdmfTimes({readFile(path), path}), (Doubles{0, 0.5}));
}

// --- Texts ---------------------------------------------------------------------------------------

std::string function(const std::string& name, const std::string& family, int degree,
                     const std::string& dofs, const std::string& values,
                     const std::string& cell = "tetrahedron") {
  return "<Attribute ItemType=\"FiniteElementFunction\" ElementFamily=\"" + family +
         "\" ElementDegree=\"" + std::to_string(degree) + "\" ElementCell=\"" + cell +
         "\" Name=\"" + name + "\" Center=\"Other\" AttributeType=\"Scalar\">" +
         "<DataItem Format=\"XML\" NumberType=\"UInt\">" + dofs + "</DataItem>" +
         "<DataItem Format=\"XML\">" + values + "</DataItem></Attribute>";
}
std::string overTime(const std::string& name, const std::string& inside) {
  return grid(grid(mesh() + "<Time Value=\"0\"/>" + inside, "Name=\"x\""),
              "Name=\"" + name + R"(" GridType="Collection" CollectionType="Temporal")");
}

CellMesh readText(const std::string& domain, Report& report, const ReadOptions& options = {}) {
  return read(readXdmf, document(domain), report, "test", options);
}

TEST(XdmfFunction, NumbersInAnyOrder) {
  // Point i has number 4 - i; the cells are 0 1 2 3 and 4 3 2 1.
  Report report;
  const CellMesh cells =
      readText(overTime("u", function("u", "CG", 1, "4 3 2 1 0 1 2 3", "50 40 30 20 10")) +
                   overTime("q", function("q", "DG", 0, "1 0", "7 8")),
               report);
  expectTwoTets(cells);
  EXPECT_EQ(numbers(cells, "u", kOnPoints), (Doubles{10, 20, 30, 40, 50}));
  EXPECT_EQ(numbers(cells, "q", kOnCells), (Doubles{8, 7}));
  EXPECT_TRUE(report.warnings.empty());
}

TEST(XdmfFunction, OfHigherDegreeAtTheCornersWithAWarning) {
  std::string dofs, values;
  const int corners[2][4] = {{0, 1, 2, 3}, {4, 3, 2, 1}};
  for (int cell = 0; cell < 2; ++cell)
    for (int k = 0; k < 10; ++k) // ten numbers a cell: corners, then edges
      dofs += std::to_string(k < 4 ? corners[cell][k] : 5) + " ";
  Report report;
  const CellMesh cells =
      readText(overTime("u", function("u", "Lagrange", 2, dofs, "1 2 3 4 5 999")), report);
  EXPECT_EQ(numbers(cells, "u", kOnPoints), (Doubles{1, 2, 3, 4, 5}));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0].code, "linear-array");
}

TEST(XdmfFunction, OthersAreLeftOutWithAWarning) {
  for (const auto& [family, degree, cell] :
       {std::tuple("RT", 1, "tetrahedron"), std::tuple("DG", 1, "tetrahedron"),
        std::tuple("CG", 1, "hexahedron"), std::tuple("CG", -1, "tetrahedron")}) {
    Report report;
    const CellMesh cells = readText(
        overTime("u", function("u", family, degree, "0 1 2 3 4 3 2 1", "1 2 3 4 5", cell)), report);
    expectTwoTets(cells);
    EXPECT_TRUE(cells.attributes.empty());
    ASSERT_EQ(report.warnings.size(), 1u) << family;
    EXPECT_EQ(report.warnings[0].code, "array-left-out");
  }
  // Nobody asks: no warning, and known by name.
  ReadOptions options;
  options.arrays = {"p"};
  Report report;
  const CellMesh cells = readText(
      overTime("u", function("u", "CG", 1, "0 1 2 3 4 3 2 1", "1 2 3 4 5")), report, options);
  EXPECT_TRUE(cells.attributes.empty());
  ASSERT_EQ(cells.unread.size(), 1u);
  EXPECT_EQ(cells.unread[0].name, "u");
}

TEST(XdmfFunction, NumbersThatDoNotFit) {
  const auto error = [](const std::string& dofs, const std::string& values) {
    Report report;
    try {
      readText(overTime("u", function("u", "CG", 1, dofs, values)), report);
    } catch (const Error& e) {
      EXPECT_EQ(e.status(), Status::Invalid);
      return std::string(e.what());
    }
    ADD_FAILURE() << "nothing was thrown";
    return std::string();
  };
  EXPECT_NE(error("0 1 2 3 4 3 2 5", "1 2 3 4 5").find("names number 5 of 5"), std::string::npos);
  EXPECT_NE(error("0 1 2 3 4 3 2 -1", "1 2 3 4 5"), "");
  EXPECT_NE(error("0 1 2 3 4 3 2", "1 2 3 4 5").find("do not fit"), std::string::npos);
  EXPECT_NE(error("", "1 2 3 4 5").find("do not fit"), std::string::npos);
}

} // namespace
} // namespace tetvdb::test
