// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "io/ResultSamples.h"
#include "io/TriangleSamples.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/formats/nastran/NastranDeck.h"
#include "tetvdb/io/formats/nastran/NastranReader.h"

#include <cmath>

namespace tetvdb {
namespace {

using namespace test;

/// Fields of `width` characters after a name of eight.
std::string fixed(std::size_t width, std::string line, const std::vector<std::string>& fields) {
  line.resize(8, ' ');
  for (const std::string& field : fields)
    line += std::string(width - field.size(), ' ') + field;
  return line + "\n";
}

// The cube with the pyramid on top, in small, large and free fields.
const std::string kControlSections = "$ comment, with a comma\n"
                                     "SOL 101\n"
                                     "CEND\n"
                                     "TITLE = CHEXA, 1, 2\n"
                                     "BEGIN BULK\n" +
                                     fixed(8, "PSOLID", {"7", "1"});
const std::string kGridEntries =
    fixed(8, "GRID", {"1", "", "0.", "0.", "0."}) + fixed(16, "GRID*", {"2", "", "1.", "0."}) +
    fixed(16, "*", {"0."}) + "GRID,3,,1.0,1.,0.0\n" +
    fixed(8, "grid", {"4", "", "0.0", "+1.", "0."}) + "GRID\t5\t\t0.\t0.\t1.0\n" +
    fixed(8, "  GRID", {"6", "", "10.-1", "0.", "1.0"}) +
    fixed(8, "GRID", {"7", "", ".1+1", "1.", "1.D+0", "0"}) +
    fixed(8, "GRID", {"8", "", "", "1.0", "1.", "0", "123"}) +
    fixed(8, "GRID", {"19", "", ".5", ".5", "2.000000"});
const std::string kElementEntries =
    fixed(8, "CHEXA", {"3", "7", "1", "2", "3", "4", "5", "6", "+A1"}) +
    fixed(8, "+A1", {"7", "8"}) + "CPYRAM,4,9,5,6,7,8,19 $ the tip\n" +
    fixed(8, "CTRIA3", {"5", "2", "1", "2", "3"}) +
    fixed(8, "CBAR", {"6", "2", "1", "2", "0.", "0.", "1."}) + "ENDDATA\n" +
    fixed(8, "GRID", {"1", "", "9.", "9.", "9."});

TEST(NastranReader, FieldsOfAllSizes) {
  const CellMesh mesh = readText(readNastran, kControlSections + kGridEntries + kElementEntries);
  ASSERT_EQ(mesh.points.size(), 9U);
  for (std::size_t i = 0; i < 9; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(mesh.points[i][k], kCubeAndTip[i][k]) << i << ' ' << k;
  EXPECT_NEAR(cellVolume(mesh), 1 + 1.0 / 3, 1e-12);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{7, 9, 2}));
}

TEST(NastranReader, WithoutControlSectionsAndInAnyOrder) {
  const std::string cells = kElementEntries.substr(0, kElementEntries.find("ENDDATA"));
  const CellMesh mesh = readText(readNastran, cells + kGridEntries);
  EXPECT_NEAR(cellVolume(mesh), 1 + 1.0 / 3, 1e-12);
}

TEST(NastranReader, Numbers) {
  const std::pair<const char*, double> numbers[] = {
      {"7.0", 7},        {".7E1", 7},        {"0.7+1", 7}, {"70.-1", 7},     {"+7.", 7},
      {"-7.-3", -0.007}, {"1.5D-3", 1.5e-3}, {"7", 7},     {"1.e+03", 1000}, {"-.5d+2", -50}};
  for (const auto& [text, value] : numbers)
    EXPECT_EQ(nastranReal(text), std::optional<double>(value)) << text;
  for (const char* text : {"", "-", "1.0.0", "1-2-3", "abc", "1.E", "nan", "1e999", "1 2",
                           "0000000000000000000000000000000000000000"})
    EXPECT_EQ(nastranReal(text), std::nullopt) << text;
}

// Each midpoint is that of its edge, in VTK's order, as volumes and shapes need it.
TEST(NastranReader, QuadraticElements) {
  struct Case {
    const char* name;
    CellType type;
    std::vector<std::array<int, 3>> corners;
    std::vector<std::array<int, 2>> edges; ///< in the order of the Quick Reference Guide
    std::vector<std::array<int, 2>> vtk;   ///< in VTK's
  };
  const Case cases[] = {
      {"CTETRA",
       CellType::Tetra,
       {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}},
       {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}},
       {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}},
      {"CPENTA",
       CellType::Wedge,
       {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {0, 2, 2}},
       {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 4}, {2, 5}, {3, 4}, {4, 5}, {5, 3}},
       {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}},
      {"CHEXA",
       CellType::Hexahedron,
       {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}},
       {{0, 1},
        {1, 2},
        {2, 3},
        {3, 0},
        {0, 4},
        {1, 5},
        {2, 6},
        {3, 7},
        {4, 5},
        {5, 6},
        {6, 7},
        {7, 4}},
       {{0, 1},
        {1, 2},
        {2, 3},
        {3, 0},
        {4, 5},
        {5, 6},
        {6, 7},
        {7, 4},
        {0, 4},
        {1, 5},
        {2, 6},
        {3, 7}}},
      {"CPYRAM",
       CellType::Pyramid,
       {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}},
       {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}},
       {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}}}};
  for (const Case& c : cases) {
    std::string deck, element = std::string(c.name) + ",1,1";
    std::vector<std::array<int, 3>> points = c.corners;
    for (const auto& [a, b] : c.edges) {
      const auto &p = c.corners[static_cast<std::size_t>(a)],
                 &q = c.corners[static_cast<std::size_t>(b)];
      points.push_back({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2});
    }
    std::size_t onLine = 2;
    for (std::size_t i = 0; i < points.size(); ++i) {
      deck += "GRID," + std::to_string(i + 1) + ",,";
      for (const int x : points[i])
        deck += std::to_string(x) + ".,";
      deck += "\n";
      if (onLine == 8) {
        element += ",+\n+";
        onLine = 0;
      }
      element += "," + std::to_string(i + 1);
      ++onLine;
    }
    const CellMesh mesh = readText(readNastran, deck + element + "\n");
    ASSERT_EQ(mesh.runs.size(), 1U) << c.name;
    EXPECT_EQ(mesh.runs[0].type, c.type);
    ASSERT_EQ(mesh.runs[0].nodesPerCell, points.size());
    for (std::size_t i = 0; i < c.vtk.size(); ++i) {
      const auto &p = c.corners[static_cast<std::size_t>(c.vtk[i][0])],
                 &q = c.corners[static_cast<std::size_t>(c.vtk[i][1])];
      const Vec3d& mid = mesh.points[mesh.nodes[c.corners.size() + i]];
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(2 * mid[k], p[k] + q[k]) << c.name << ' ' << i;
    }
    // With a midpoint missing, the corners.
    const std::string last = "," + std::to_string(points.size());
    const CellMesh linear =
        readText(readNastran, deck + element.substr(0, element.size() - last.size()) + "\n");
    EXPECT_EQ(linear.runs[0].nodesPerCell, c.corners.size());
  }
}

TEST(NastranReader, CoordinateSystems) {
  // 1: moved and turned about z by 90 degrees; 2: cylindrical in 1; 3: spherical, by points that
  // are given in 1 and in the basic system.
  const std::string systems = "CORD2R,1,0,10.,0.,0.,10.,0.,1.\n,10.,1.,0.\n"
                              "CORD2C,2,1,0.,0.,0.,0.,0.,5.\n,1.,0.,0.\n"
                              "CORD1S,3,101,102,103\n"
                              "GRID,101,1,0.,0.,0.\nGRID,102,,10.,0.,3.\nGRID,103,,11.,0.,0.\n";
  const std::string tet = "CTETRA,1,1,1,2,3,4\n";
  const auto points = [&](const std::string& grids) {
    return readText(readNastran, systems + grids + tet).points;
  };
  const std::vector<Vec3d> found = points("GRID,1,1,1.,2.,3.\nGRID,2,2,2.,90.,1.\n"
                                          "GRID,3,3,2.,90.,90.\nGRID,4,0,1.,2.,3.\n");
  const Vec3d expected[] = {{8, 1, 3}, {8, 0, 1}, {10, 2, 0}, {1, 2, 3}};
  ASSERT_EQ(found.size(), 7U);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(found[3 + i][k], expected[i][k], 1e-14) << i;
  // GRDSET names the system of points that name none.
  const std::vector<Vec3d> set = points("GRDSET,,1\nGRID,1,,1.,2.,3.\nGRID,2,0,1.,2.,3.\n"
                                        "GRID,3,,0.,0.,0.\nGRID,4,,0.,0.,1.\n");
  EXPECT_NEAR(set[3][0], 8, 1e-14);
  EXPECT_EQ(set[4], (Vec3d{1, 2, 3}));
}

TEST(NastranReader, IncludedFiles) {
  const TemporaryPath points("nastran_points.bdf"), cells("nastran_cells.bdf"),
      deck("nastran_deck.bdf");
  const auto read = [&] {
    const MappedFile file(deck.str());
    Report report;
    Progress progress;
    EXPECT_TRUE(nastranHasSolidCells(file.source(), report, progress));
    return readNastran(file.source(), {}, report, progress);
  };
  const std::string pointsName = points.name();
  points.write(kGridEntries);
  cells.write(kElementEntries); // its ENDDATA is its own end
  // A long name goes on in the next line.
  deck.write(kControlSections + "INCLUDE '" + pointsName.substr(0, 9) + "\n" +
             pointsName.substr(9) + "'\ninclude " + cells.name() + "\nCTRIA3,20,3,1,2,3\n");
  const CellMesh mesh = read();
  EXPECT_NEAR(cellVolume(mesh), 1 + 1.0 / 3, 1e-12);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{7, 9, 2, 3}));
  cells.write("INCLUDE " + cells.name() + "\n"); // itself
  EXPECT_THROW(read(), Error);
}

TEST(NastranReader, SurfacesAndSolids) {
  Report report;
  Progress progress;
  const std::string shells =
      kGridEntries + "CQUAD4,1,1,1,2,3,4\nCTRIA6,2,1,1,2,3,5,6,7\nCTRIAR,3,1,1,3,4\n";
  EXPECT_FALSE(nastranHasSolidCells({shells, "a.bdf"}, report, progress));
  EXPECT_TRUE(nastranHasSolidCells({shells + kElementEntries, "a.bdf"}, report, progress));
  ReadOptions faces;
  faces.faces = true;
  const TriangleMesh mesh =
      trianglesOfFaces(readNastran({shells, "a.bdf"}, faces, report, progress), "a.bdf");
  EXPECT_EQ(mesh.triangles, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 0, 1, 2, 0, 2, 3}));
}

TEST(NastranReader, Refused) {
  const auto expectError = [](const std::string& deck, const char* says) {
    EXPECT_NE(readingError(readNastran, deck).find(says), std::string::npos)
        << says << ": " << readingError(readNastran, deck);
  };
  expectError("CTETRA,1,1,1,2,3,4\n", "no points");
  expectError(kGridEntries + "CTETRA,1,1,1,2,3,40\n", "node 40, which does not exist");
  expectError(kGridEntries + "CTETRA,1,1,1,2,3\n", "no node from 1");
  expectError(kGridEntries + "CTETRA,1,1,1,2,3,x\n", "field 7 is 'x'");
  expectError("GRID,1,,1.0.0,0.,0.\n", "'1.0.0' in place of a number");
  expectError("GRID,,,1.,0.,0.\n", "no number");
  expectError("GRID,4294967295,,1.,0.,0.\n", "no number");
  expectError("INCLUDE 'there-is-none.bdf'\n" + kGridEntries, "there-is-none.bdf");
  expectError("GRID,1,5,1.,0.,0.\n", "coordinate system 5");
  expectError("CORD2R,5,6,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,6,5,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
              "GRID,1,5,1.,0.,0.\n",
              "coordinate system 5");
  expectError("CORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,0.,2.\nGRID,1,5,1.,0.,0.\n", "coordinate system 5");
  // A chain of systems that would fill the stack.
  std::string chain = "GRID,1,100000,1.,0.,0.\n";
  for (int i = 1; i <= 100000; ++i)
    chain += "CORD2R," + std::to_string(i) + "," + std::to_string(i - 1) +
             ",0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n";
  expectError(chain, "coordinate system 100000");
}

} // namespace
} // namespace tetvdb
