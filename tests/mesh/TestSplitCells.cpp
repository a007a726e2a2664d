// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/mesh/SplitPolyhedron.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numeric>
#include <random>
#include <rapidcheck/gtest.h>

namespace tetvdb {
namespace {

using Nodes = std::vector<std::uint32_t>;

void addCell(CellMesh& mesh, CellType type, const Nodes& nodes, const char* name = "cell") {
  const auto each = static_cast<std::uint32_t>(nodes.size());
  if (mesh.runs.empty() || mesh.runs.back().type != type || mesh.runs.back().nodesPerCell != each ||
      mesh.runs.back().fileType != name)
    mesh.runs.push_back({type, each, 0, name, false});
  ++mesh.runs.back().count;
  mesh.nodes.insert(mesh.nodes.end(), nodes.begin(), nodes.end());
}

TetMesh split(CellMesh mesh, const CellFilter& filter = {}, Report* report = nullptr) {
  Report own;
  Progress progress;
  return splitCells(std::move(mesh), filter, report != nullptr ? *report : own, progress);
}

double volume(const TetMesh& mesh, std::size_t t) {
  const std::uint32_t* n = mesh.tets.data() + 4 * t;
  return sixfoldVolume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]], mesh.points[n[3]]) /
         6;
}

double absoluteVolume(const TetMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t)
    sum += std::abs(volume(mesh, t));
  return sum;
}

const std::vector<Vec3d> kCube{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                               {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

std::vector<Vec3d> prismPoints(int sides) {
  std::vector<Vec3d> points;
  for (const double z : {0.0, 2.0})
    for (int i = 0; i < sides; ++i) {
      const double angle = 6.283185307179586 * i / sides;
      points.push_back({std::cos(angle), std::sin(angle), z});
    }
  return points;
}

double prismVolume(int sides) {
  return 2 * sides * 0.5 * std::sin(6.283185307179586 / sides);
}

struct Shape {
  CellType type;
  std::vector<Vec3d> points;
  double volume;
  std::size_t tets;
};

std::vector<Shape> shapes() {
  return {
      {CellType::Tetra, {kCube[0], kCube[1], kCube[3], kCube[4]}, 1.0 / 6, 1},
      {CellType::Hexahedron, kCube, 1, 6},
      {CellType::Voxel,
       {kCube[0], kCube[1], kCube[3], kCube[2], kCube[4], kCube[5], kCube[7], kCube[6]},
       1,
       6},
      {CellType::Wedge, prismPoints(3), prismVolume(3), 3},
      {CellType::Pyramid, {kCube[0], kCube[1], kCube[2], kCube[3], {0.3, 0.4, 2}}, 2.0 / 3, 2},
      {CellType::PentagonalPrism, prismPoints(5), prismVolume(5), 9},
      {CellType::HexagonalPrism, prismPoints(6), prismVolume(6), 12},
  };
}

Nodes identity(std::size_t n) {
  Nodes nodes(n);
  std::iota(nodes.begin(), nodes.end(), 0U);
  return nodes;
}

// The vertex that a cell is cut from depends on its pose, so many poses see every case.
RC_GTEST_PROP(SplitCells, VolumesOfEveryShapeInAnyPose, (std::uint32_t seed)) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  double m[3][3];
  double determinant = 0;
  do {
    for (auto& row : m)
      for (double& x : row)
        x = uniform(random);
    determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                  m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                  m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  } while (std::abs(determinant) < 0.01);
  for (const Shape& shape : shapes()) {
    CellMesh mesh;
    for (const Vec3d& p : shape.points) {
      Vec3d q;
      for (std::size_t k = 0; k < 3; ++k)
        q[k] = m[k][0] * p[0] + m[k][1] * p[1] + m[k][2] * p[2];
      mesh.points.push_back(q);
    }
    addCell(mesh, shape.type, identity(shape.points.size()));
    Report report;
    const TetMesh tets = split(mesh, {}, &report);
    RC_ASSERT(tets.tetCount() == shape.tets);
    RC_ASSERT(report.warnings.empty());
    const double wanted = shape.volume * std::abs(determinant);
    RC_ASSERT(std::abs(absoluteVolume(tets) - wanted) < 1e-12);
    // All on one side: they do not overlap.
    double sum = 0;
    for (std::size_t t = 0; t < tets.tetCount(); ++t)
      sum += volume(tets, t);
    RC_ASSERT(std::abs(std::abs(sum) - wanted) < 1e-12);
  }
}

Nodes polyhedronCube(const Nodes& c) {
  const int faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                           {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  Nodes nodes{6};
  for (const auto& face : faces) {
    nodes.push_back(4);
    for (const int corner : face)
      nodes.push_back(c[static_cast<std::size_t>(corner)]);
  }
  return nodes;
}

/// A lattice of jittered cubes, each as one hexahedron, voxel, polyhedron or six
/// pyramids, its points numbered at random.
struct Lattice {
  CellMesh mesh;
  std::size_t side;
  Nodes numberOf; ///< by lattice order

  Lattice(std::size_t n, std::uint32_t seed) : side(n) {
    std::mt19937 random(seed);
    const std::size_t s = n + 1;
    std::vector<Vec3d> points;
    // Few distinct values, so that coordinates tie.
    std::uniform_int_distribution<int> jitter(-2, 2);
    for (std::size_t x = 0; x < s; ++x)
      for (std::size_t y = 0; y < s; ++y)
        for (std::size_t z = 0; z < s; ++z)
          points.push_back({static_cast<double>(x) + 0.05 * jitter(random),
                            static_cast<double>(y) + 0.05 * jitter(random),
                            static_cast<double>(z) + 0.05 * jitter(random)});
    struct Cell {
      CellType type;
      Nodes nodes;
    };
    std::vector<Cell> cells;
    for (std::size_t x = 0; x < n; ++x)
      for (std::size_t y = 0; y < n; ++y)
        for (std::size_t z = 0; z < n; ++z) {
          const auto at = [&](std::size_t dx, std::size_t dy, std::size_t dz) {
            return static_cast<std::uint32_t>(((x + dx) * s + y + dy) * s + z + dz);
          };
          Nodes c{at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0),
                  at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)};
          const auto kind = random() % 4;
          // A quarter turn changes nothing but the order of the corners.
          if (random() % 2 == 0)
            c = {c[3], c[0], c[1], c[2], c[7], c[4], c[5], c[6]};
          if (kind == 0) {
            cells.push_back({CellType::Hexahedron, c});
          } else if (kind == 1) {
            cells.push_back({CellType::Voxel, {c[0], c[1], c[3], c[2], c[4], c[5], c[7], c[6]}});
          } else if (kind == 2) {
            Vec3d midpoint{0, 0, 0};
            for (const std::uint32_t corner : c)
              for (std::size_t k = 0; k < 3; ++k)
                midpoint[k] += points[corner][k] / 8;
            const auto apex = static_cast<std::uint32_t>(points.size());
            points.push_back(midpoint);
            const Nodes p = polyhedronCube(c);
            for (std::size_t f = 0; f < 6; ++f)
              cells.push_back({CellType::Pyramid,
                               {p[2 + 5 * f], p[3 + 5 * f], p[4 + 5 * f], p[5 + 5 * f], apex}});
          } else {
            cells.push_back({CellType::Polyhedron, polyhedronCube(c)});
          }
        }
    Nodes order = identity(points.size());
    std::shuffle(order.begin(), order.end(), random);
    mesh.points.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      mesh.points[order[i]] = points[i];
    std::shuffle(cells.begin(), cells.end(), random);
    for (Cell& cell : cells) {
      if (cell.type == CellType::Polyhedron) {
        std::size_t at = 1;
        for (int f = 0; f < 6; ++f, at += 5)
          for (std::size_t k = 1; k <= 4; ++k)
            cell.nodes[at + k] = order[cell.nodes[at + k]];
      } else {
        for (std::uint32_t& node : cell.nodes)
          node = order[node];
      }
      addCell(mesh, cell.type, cell.nodes);
    }
    numberOf = order;
  }
};

using Triangle = std::array<std::uint32_t, 3>;

std::map<Triangle, int> faceCounts(const TetMesh& mesh) {
  std::map<Triangle, int> counts;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t)
    for (std::size_t skip = 0; skip < 4; ++skip) {
      Triangle face;
      std::size_t n = 0;
      for (std::size_t k = 0; k < 4; ++k)
        if (k != skip)
          face[n++] = mesh.tets[4 * t + k];
      std::sort(face.begin(), face.end());
      ++counts[face];
    }
  return counts;
}

RC_GTEST_PROP(SplitCells, NeighboursAgreeOnSharedFaces, (std::uint32_t seed)) {
  const std::size_t n = 3;
  const TetMesh tets = split(Lattice(n, seed).mesh);
  std::size_t boundary = 0;
  for (const auto& [face, count] : faceCounts(tets)) {
    RC_ASSERT(count <= 2);
    boundary += count == 1 ? 1 : 0;
  }
  RC_ASSERT(boundary == 6 * n * n * 2);
}

TEST(SplitCells, WedgesAndHexahedraAgree) {
  // A prism of two wedges standing on a hexahedron's side: they share quads, not triangles.
  CellMesh mesh;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k)
        mesh.points.push_back({i + 0.1 * j, j - 0.07 * k, k + 0.03 * i});
  const auto at = [](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    return (i * 2 + j) * 2 + k;
  };
  addCell(mesh, CellType::Hexahedron,
          {at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0), at(0, 0, 1), at(1, 0, 1),
           at(1, 1, 1), at(0, 1, 1)});
  addCell(mesh, CellType::Wedge,
          {at(1, 0, 0), at(2, 0, 0), at(2, 1, 0), at(1, 0, 1), at(2, 0, 1), at(2, 1, 1)});
  addCell(mesh, CellType::Wedge,
          {at(1, 0, 0), at(2, 1, 0), at(1, 1, 0), at(1, 0, 1), at(2, 1, 1), at(1, 1, 1)});
  const TetMesh tets = split(mesh);
  EXPECT_EQ(tets.tetCount(), 12U);
  std::size_t boundary = 0;
  for (const auto& [face, count] : faceCounts(tets)) {
    EXPECT_LE(count, 2);
    boundary += count == 1 ? 1 : 0;
  }
  EXPECT_EQ(boundary, 20U);
}

// The same tets, by position, whatever the numbers of the points.
TEST(SplitCells, RenumberingChangesNothing) {
  const auto positions = [](const Lattice& lattice) {
    const TetMesh tets = split(lattice.mesh);
    std::vector<std::array<Vec3d, 4>> all;
    for (std::size_t t = 0; t < tets.tetCount(); ++t) {
      std::array<Vec3d, 4> tet;
      for (std::size_t k = 0; k < 4; ++k)
        tet[k] = tets.points[tets.tets[4 * t + k]];
      std::sort(tet.begin(), tet.end());
      all.push_back(tet);
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  Lattice lattice(2, 5);
  const auto before = positions(lattice);
  // Turn the numbers round.
  const auto last = static_cast<std::uint32_t>(lattice.mesh.points.size() - 1);
  std::reverse(lattice.mesh.points.begin(), lattice.mesh.points.end());
  std::size_t at = 0;
  for (const CellRun& run : lattice.mesh.runs)
    for (std::size_t i = 0; i < run.count; ++i, at += run.nodesPerCell)
      for (std::size_t k = 0; k < run.nodesPerCell; ++k) {
        const bool isCount = run.type == CellType::Polyhedron && (k == 0 || k % 5 == 1);
        std::uint32_t& node = lattice.mesh.nodes[at + k];
        if (!isCount)
          node = last - node;
      }
  EXPECT_EQ(positions(lattice), before);
}

TEST(SplitCells, CollapsedHexahedronLosesTetsButNoVolume) {
  CellMesh mesh;
  mesh.points = kCube;
  addCell(mesh, CellType::Hexahedron, {0, 1, 2, 2, 4, 5, 6, 6}); // a wedge written as a hexahedron
  EXPECT_NEAR(absoluteVolume(split(mesh)), 0.5, 1e-15);
}

TEST(SplitCells, LinearTetsAreMovedNotCopied) {
  CellMesh mesh;
  mesh.points = kCube;
  for (int i = 0; i < 3; ++i)
    addCell(mesh, CellType::Tetra, {0, 1, 3, 4});
  const std::uint32_t* nodes = mesh.nodes.data();
  const Vec3d* points = mesh.points.data();
  Report report;
  Progress progress;
  const TetMesh tets = splitCells(std::move(mesh), {}, report, progress);
  EXPECT_EQ(tets.tets.data(), nodes);
  EXPECT_EQ(tets.points.data(), points);
  EXPECT_TRUE(tets.cellOfTet.empty());
  EXPECT_EQ(tets.cellCount, 3U);
}

CellMesh mixedMesh() {
  CellMesh mesh;
  mesh.points = kCube;
  addCell(mesh, CellType::Flat, {0, 1, 2}, "triangle");
  addCell(mesh, CellType::Tetra, {0, 1, 3, 4}, "tetra");
  addCell(mesh, CellType::Flat, {}, "line");
  mesh.runs.back().count = 2;
  addCell(mesh, CellType::Hexahedron, identity(8), "hexahedron");
  addCell(mesh, CellType::Tetra, {1, 2, 3, 6}, "tetra");
  mesh.attributes.push_back(
      {"heat", Attribute::On::Cells, 2, std::vector<float>{0, 0, 1, 1, 0, 0, 0, 0, 2, 2, 3, 3}});
  mesh.attributes.push_back({"x", Attribute::On::Points, 1, std::vector<double>(8, 1)});
  mesh.regions = {9, 1, 9, 9, 2, 3};
  mesh.regionNames = {{1, "steel"}, {2, "2"}, {9, "skin"}};
  return mesh;
}

TEST(SplitCells, CellValuesAreNumberedBySolidCell) {
  const TetMesh tets = split(mixedMesh());
  EXPECT_EQ(tets.cellCount, 3U);
  ASSERT_EQ(tets.tetCount(), 8U);
  EXPECT_EQ(tets.cell(0), 0U);
  EXPECT_EQ(tets.cell(6), 1U);
  EXPECT_EQ(tets.cell(7), 2U);
  EXPECT_EQ(std::get<std::vector<float>>(tets.attributes[0].values),
            (std::vector<float>{1, 1, 2, 2, 3, 3}));
  EXPECT_EQ(tets.attributes[1].size(), 8U);
  EXPECT_EQ(tets.regions, (std::vector<std::int32_t>{1, 2, 3}));
}

TEST(SplitCells, RegionsByNameAndNumber) {
  CellFilter filter;
  filter.regions = {"steel", "3"};
  TetMesh tets = split(mixedMesh(), filter);
  EXPECT_EQ(tets.cellOfTet, (Nodes{0, 2}));
  EXPECT_EQ(tets.cellCount, 3U);
  EXPECT_EQ(tets.regions.size(), 3U);
  filter = {};
  filter.exclude = {"2"};
  EXPECT_EQ(split(mixedMesh(), filter).cellOfTet, (Nodes{0, 2}));
  filter.regions = {"steel"};
  filter.exclude = {"steel"};
  EXPECT_THROW(split(mixedMesh(), filter), Error);
}

TEST(SplitCells, UnknownRegionNamesThoseThere) {
  CellFilter filter;
  filter.regions = {"9"}; // flat cells only
  try {
    split(mixedMesh(), filter);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Usage);
    EXPECT_NE(std::string(error.what()).find("1 'steel'"), std::string::npos) << error.what();
  }
}

TEST(SplitCells, BoxKeepsCellsThatMeetIt) {
  CellMesh mesh;
  for (int i = 0; i < 3; ++i)
    for (const Vec3d& p : kCube)
      mesh.points.push_back({p[0] + 2 * i, p[1], p[2]});
  for (std::uint32_t i = 0; i < 3; ++i)
    addCell(mesh, CellType::Tetra, {8 * i, 8 * i + 1, 8 * i + 3, 8 * i + 4});
  CellFilter filter;
  filter.boxMin[0] = 1; // touches the first
  filter.boxMax[0] = 2.5;
  EXPECT_EQ(split(mesh, filter).cellOfTet, (Nodes{0, 1}));
  filter.boxMin[1] = 5;
  EXPECT_THROW(split(mesh, filter), Error);
}

TEST(SplitCells, SkippedCellsLeaveHolesAndSaySo) {
  CellMesh mesh = mixedMesh();
  mesh.runs.push_back({CellType::OtherSolid, 0, 2, "lagrange-hex", false});
  mesh.regions.insert(mesh.regions.end(), {1, 1});
  std::get<std::vector<float>>(mesh.attributes[0].values).resize(16);
  Report report;
  const TetMesh tets = split(mesh, {}, &report);
  EXPECT_EQ(tets.cellCount, 5U);
  EXPECT_TRUE(report.partial);
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_EQ(report.warnings[0].code, "skipped-cells");
  EXPECT_NE(report.warnings[0].text.find("2 lagrange-hex"), std::string::npos);
}

TEST(SplitCells, SurfaceAloneIsRefusedWithItsContent) {
  CellMesh mesh;
  mesh.points = kCube;
  mesh.runs.push_back({CellType::Flat, 0, 694, "triangle", false});
  try {
    split(mesh);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Invalid);
    EXPECT_NE(std::string(error.what()).find("694 triangles"), std::string::npos);
  }
}

// Beside other cells; see TestCutTet10.cpp for those that are alone.
TEST(SplitCells, QuadraticCellsAreTakenByTheirCorners) {
  CellMesh mesh;
  mesh.points = kCube;
  mesh.points.resize(14, Vec3d{0.5, 0.5, 0.5});
  mesh.runs.push_back({CellType::Tetra, 10, 1, "tetra10", true});
  mesh.runs.push_back({CellType::Tetra, 4, 1, "tetra", false});
  mesh.nodes = {0, 1, 3, 4, 8, 9, 10, 11, 12, 13, 1, 2, 3, 6};
  Report report;
  const TetMesh tets = split(mesh, {}, &report);
  EXPECT_EQ(tets.tets, (Nodes{0, 1, 3, 4, 1, 2, 3, 6}));
  EXPECT_TRUE(tets.curved.empty());
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_EQ(report.warnings[0].code, "quadratic-cells");
}

TEST(SplitPolyhedron, FacesNeedNoCommonOrientation) {
  CellMesh mesh;
  mesh.points = kCube;
  Nodes nodes = polyhedronCube(identity(8));
  std::reverse(nodes.begin() + 2, nodes.begin() + 6);
  addCell(mesh, CellType::Polyhedron, nodes, "polyhedron");
  EXPECT_NEAR(absoluteVolume(split(mesh)), 1, 1e-15);
}

// A cube with its top pushed in to vertex 8.
Nodes dentedCube() {
  return {9, 4, 0, 3, 2, 1, 4, 0, 1, 5, 4, 4, 1, 2, 6, 5, 4, 2, 3, 7, 6,
          4, 3, 0, 4, 7, 3, 4, 5, 8, 3, 5, 6, 8, 3, 6, 7, 8, 3, 7, 4, 8};
}

struct Cut {
  PolyhedronCut how;
  TetMesh mesh;
};

Cut cutOf(const Nodes& nodes, std::vector<Vec3d> points) {
  Cut cut{PolyhedronCut::None, {}};
  cut.how =
      PolyhedronCutter(points).cut(polyhedronFaces(nodes.data(), nodes.size()), cut.mesh.tets);
  cut.mesh.points = std::move(points);
  return cut;
}

TEST(SplitPolyhedron, DentedOnesGetAPointWithin) {
  std::vector<Vec3d> points = kCube;
  // A little, and all faces are still seen from the corner at 0.
  points.push_back({0.5, 0.5, 0.6});
  const Cut little = cutOf(dentedCube(), points);
  EXPECT_EQ(little.how, PolyhedronCut::FromVertex);
  EXPECT_EQ(little.mesh.points.size(), 9u);
  EXPECT_NEAR(absoluteVolume(little.mesh), 1 - 0.4 / 3, 1e-15);
  // The far sides of the dent are hidden from a smallest vertex on the rim, not from the mean.
  points[8] = {0.5, 0.5, 0.8};
  points[4] = {-0.01, 0, 1};
  const Cut around = cutOf(dentedCube(), points);
  EXPECT_EQ(around.how, PolyhedronCut::AroundCentre);
  EXPECT_EQ(around.mesh.points.size(), 10u);
  // Through the dent, and tets are inverted, but none reaches out of the cell's hull.
  points = kCube;
  points.push_back({0.5, 0.5, 0.1});
  const Cut deep = cutOf(dentedCube(), points);
  EXPECT_EQ(deep.how, PolyhedronCut::Concave);
  double sum = 0;
  for (std::size_t t = 0; t < deep.mesh.tetCount(); ++t) {
    const std::uint32_t* v = deep.mesh.tets.data() + 4 * t;
    const auto& p = deep.mesh.points;
    sum += sixfoldVolume(p[v[0]], p[v[1]], p[v[2]], p[v[3]]) / 6;
  }
  EXPECT_NEAR(std::abs(sum), 1 - 0.9 / 3, 1e-14);
}

TEST(SplitPolyhedron, OpenOnesAreSkipped) {
  Nodes open = polyhedronCube(identity(8));
  open[0] = 5;
  open.resize(26);
  const Cut cut = cutOf(open, kCube);
  EXPECT_EQ(cut.how, PolyhedronCut::None);
  EXPECT_TRUE(cut.mesh.tets.empty());
}

// Two prisms over a pentagon that is not flat, in one mesh: they share the pentagon, and its point.
TEST(SplitPolyhedron, NeighboursShareThePointOfAFace) {
  std::vector<Vec3d> points;
  for (const double z : {0.0, 1.0, 2.0})
    for (int i = 0; i < 5; ++i)
      points.push_back({std::cos(i * 1.2566370614359172), std::sin(i * 1.2566370614359172),
                        z + (z == 1 && i == 2 ? 0.3 : 0)});
  const auto prism = [](std::uint32_t first) {
    Nodes nodes{7};
    for (const std::uint32_t base : {first, first + 5}) {
      nodes.push_back(5);
      for (std::uint32_t i = 0; i < 5; ++i)
        nodes.push_back(base + i);
    }
    for (std::uint32_t i = 0; i < 5; ++i) {
      const std::uint32_t next = (i + 1) % 5;
      nodes.insert(nodes.end(), {4, first + i, first + next, first + 5 + next, first + 5 + i});
    }
    return nodes;
  };
  CellMesh mesh;
  mesh.points = points;
  for (const std::uint32_t first : {0u, 5u}) {
    const Nodes nodes = prism(first);
    addCell(mesh, CellType::Polyhedron, nodes, "polyhedron");
  }
  std::vector<double> x, one(15, 0.1);
  std::vector<std::int32_t> number;
  for (std::size_t i = 0; i < points.size(); ++i) {
    x.push_back(points[i][0] - 2 * points[i][2]);
    number.push_back(static_cast<std::int32_t>(i));
  }
  mesh.attributes.push_back({"x", Attribute::On::Points, 1, x});
  mesh.attributes.push_back({"one", Attribute::On::Points, 1, one});
  mesh.attributes.push_back({"number", Attribute::On::Points, 1, number});
  const TetMesh tets = split(mesh);
  // Every inner triangle belongs to two tets, so that the two cells fit.
  std::map<std::array<std::uint32_t, 3>, int> faces;
  for (std::size_t t = 0; t < tets.tetCount(); ++t)
    for (int left = 0; left < 4; ++left) {
      std::array<std::uint32_t, 3> face{};
      std::size_t n = 0;
      for (int k = 0; k < 4; ++k)
        if (k != left)
          face[n++] = tets.tets[4 * t + static_cast<std::size_t>(k)];
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
  std::size_t outer = 0;
  for (const auto& [face, count] : faces) {
    EXPECT_LE(count, 2);
    outer += count == 1 ? 1 : 0;
  }
  EXPECT_EQ(outer, 2 * 3u + 2 * 10u); // two flat pentagons, ten quadrilaterals
  const double area = 2.5 * std::sin(1.2566370614359172);
  EXPECT_NEAR(absoluteVolume(tets), 2 * area, 1e-12);
  EXPECT_EQ(tets.points.size(), 18u); // the face's, and the two cells'
  for (std::size_t i = 0; i < tets.points.size(); ++i) {
    EXPECT_NEAR(tets.attributes[0].number(i), tets.points[i][0] - 2 * tets.points[i][2], 1e-12);
    EXPECT_EQ(tets.attributes[1].number(i), 0.1);
    EXPECT_LT(tets.attributes[2].number(i), 15);
  }
}

TEST(SplitPolyhedron, ContradictoryNumbersHaveNoFaces) {
  const Nodes bad{6, 4, 0, 1, 2};
  EXPECT_EQ(polyhedronFaces(bad.data(), bad.size()).count(), 0U);
  EXPECT_EQ(polyhedronFaces(nullptr, 0).count(), 0U);
}

} // namespace
} // namespace tetvdb
