// SPDX-License-Identifier: Apache-2.0
//
// Every format's order of quadratic cells' nodes, said here by the corners that each node is in the
// middle of, into VTK's.
#include "QuadraticMesh.h"
#include "io/MeshSamples.h"
#include "tetvdb/io/cells/NodeOrder.h"
#include "tetvdb/io/formats/abaqus/AbaqusReader.h"
#include "tetvdb/io/formats/exodus/ExodusReader.h"
#include "tetvdb/io/formats/gmsh/GmshReader.h"
#include "tetvdb/io/formats/medit/MeditReader.h"
#include "tetvdb/io/formats/netgen/NetgenReader.h"
#include "tetvdb/io/formats/tetgen/TetGenReader.h"
#include "tetvdb/io/formats/vtk/VtkReader.h"

#include <algorithm>
#include <cstdio>
#include <netcdf.h>
#include <unistd.h>

namespace tetvdb {
namespace {

using namespace test;
using Sets = std::vector<std::vector<int>>;

const meshes::QuadraticKind& kindOf(const std::string& name) {
  static const std::vector<meshes::QuadraticKind> all = meshes::quadraticKinds();
  return *std::find_if(all.begin(), all.end(), [&](const auto& kind) { return kind.name == name; });
}

// A cell as a file has it: the corners, then a node in the middle of each of `sets`; sheared, so
// that no two places are alike.
std::vector<Vec3d> cellPoints(const meshes::QuadraticKind& kind, const Sets& sets) {
  std::vector<Vec3d> points;
  for (const Vec3d& c : kind.corners)
    points.push_back({c[0] + 0.3 * c[1], c[1] + 0.2 * c[2], c[2] - 0.1 * c[0]});
  for (const std::vector<int>& set : sets) {
    Vec3d midpoint{0, 0, 0};
    for (const int c : set)
      for (std::size_t k = 0; k < 3; ++k)
        midpoint[k] += points[static_cast<std::size_t>(c)][k] / static_cast<double>(set.size());
    points.push_back(midpoint);
  }
  return points;
}

void expectVtkOrder(const CellMesh& mesh, const meshes::QuadraticKind& kind) {
  ASSERT_FALSE(mesh.runs.empty());
  ASSERT_EQ(mesh.runs.back().nodesPerCell, kind.nodes());
  ASSERT_EQ(mesh.nodes.size(), kind.nodes());
  const std::vector<Vec3d> expected = cellPoints(kind, kind.middles);
  for (std::size_t i = 0; i < expected.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(mesh.points[mesh.nodes[i]][k], expected[i][k], 1e-12) << kind.name << " " << i;
}

std::string rowsOf(const std::vector<Vec3d>& points, bool numbered, const std::string& between) {
  std::ostringstream text;
  text.precision(17);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (numbered)
      text << i + 1 << between;
    text << points[i][0] << between << points[i][1] << between << points[i][2] << "\n";
  }
  return text.str();
}

std::string numbersTo(std::size_t n, const std::string& between) {
  std::string text;
  for (std::size_t i = 1; i <= n; ++i)
    text += (i == 1 ? "" : between) + std::to_string(i);
  return text;
}

// Of Gmsh's reference manual, "Node ordering": edges, then faces, then the cell.
struct GmshKind {
  const char* name;
  int type;
  Sets sets;
};

std::vector<GmshKind> gmshKinds() {
  const Sets hexEdges{{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3},
                      {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};
  Sets hex27 = hexEdges;
  for (const std::vector<int>& face : Sets{{0, 3, 2, 1},
                                           {0, 1, 5, 4},
                                           {0, 4, 7, 3},
                                           {1, 2, 6, 5},
                                           {2, 3, 7, 6},
                                           {4, 5, 6, 7},
                                           {0, 1, 2, 3, 4, 5, 6, 7}})
    hex27.push_back(face);
  const Sets wedgeEdges{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}};
  Sets wedge18 = wedgeEdges;
  for (const std::vector<int>& face : Sets{{0, 1, 4, 3}, {0, 3, 5, 2}, {1, 2, 5, 4}})
    wedge18.push_back(face);
  const Sets pyramidEdges{{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 4}, {2, 3}, {2, 4}, {3, 4}};
  Sets pyramid14 = pyramidEdges;
  pyramid14.push_back({0, 1, 2, 3});
  return {{"tet10", 11, {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}}},
          {"hex20", 17, hexEdges},
          {"hex27", 12, hex27},
          {"wedge15", 18, wedgeEdges},
          {"wedge18", 13, wedge18},
          {"pyramid13", 19, pyramidEdges},
          {"pyramid14", 14, pyramid14}};
}

TEST(NodeOrder, GmshText) {
  for (const GmshKind& gmsh : gmshKinds()) {
    const auto& kind = kindOf(gmsh.name);
    const std::vector<Vec3d> points = cellPoints(kind, gmsh.sets);
    const std::string n = std::to_string(points.size());
    expectVtkOrder(readText(readGmsh, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + n + "\n" +
                                          rowsOf(points, true, " ") +
                                          "$EndNodes\n$Elements\n1\n1 " +
                                          std::to_string(gmsh.type) + " 2 1 1 " +
                                          numbersTo(points.size(), " ") + "\n$EndElements\n"),
                   kind);
  }
}

TEST(NodeOrder, GmshBinary) {
  for (const GmshKind& gmsh : gmshKinds()) {
    const auto& kind = kindOf(gmsh.name);
    const std::vector<Vec3d> points = cellPoints(kind, gmsh.sets);
    const std::size_t n = points.size();
    Bytes two; // version 2.2
    two.text("$MeshFormat\n2.2 1 8\n")
        .ints({1})
        .text("\n$EndMeshFormat\n$Nodes\n" + std::to_string(n) + "\n");
    for (std::size_t i = 0; i < n; ++i)
      two.ints({static_cast<std::int32_t>(i + 1)})
          .doubles({points[i][0], points[i][1], points[i][2]});
    two.text("\n$EndNodes\n$Elements\n1\n").ints({gmsh.type, 1, 2, 1, 1, 1});
    for (std::size_t i = 0; i < n; ++i)
      two.ints({static_cast<std::int32_t>(i + 1)});
    two.text("\n$EndElements\n");
    expectVtkOrder(readText(readGmsh, two.str()), kind);

    Bytes four; // version 4.1
    four.text("$MeshFormat\n4.1 1 8\n").ints({1}).text("\n$EndMeshFormat\n$Nodes\n");
    four.sizes({1, n, 1, n}).ints({3, 1, 0}).sizes({n});
    for (std::size_t i = 0; i < n; ++i)
      four.sizes({i + 1});
    for (const Vec3d& p : points)
      four.doubles({p[0], p[1], p[2]});
    four.text("\n$EndNodes\n$Elements\n").sizes({1, 1, 1, 1}).ints({3, 1, gmsh.type}).sizes({1, 1});
    for (std::size_t i = 0; i < n; ++i)
      four.sizes({i + 1});
    four.text("\n$EndElements\n");
    expectVtkOrder(readText(readGmsh, four.str()), kind);
  }
}

// A file of Gmsh's own, or of who reads its manual likewise: each mid is nearest to its own edge.
TEST(NodeOrder, GmshOwnFile) {
  CellMesh mesh = readText(readGmsh, readFile(dataFile("quadratic_sphere_tet.msh")));
  const std::vector<std::uint32_t> before = mesh.nodes;
  orderMids(mesh);
  EXPECT_EQ(mesh.nodes, before);
}

// MFEM's mesh of quadratic tets, hexahedra and wedges, slightly curved: each node is nearest to the
// middle that is its own.
TEST(NodeOrder, VtkOfMfem) {
  const CellMesh mesh = readText(readVtk, readFile(dataFile("vtk/mfem__fichera-mixed-p2.vtk")));
  const std::uint32_t* nodes = mesh.nodes.data();
  std::size_t checked = 0;
  for (const CellRun& run : mesh.runs) {
    const auto& kind = kindOf(run.type == CellType::Tetra   ? "tet10"
                              : run.type == CellType::Wedge ? "wedge18"
                                                            : "hex27");
    for (std::size_t i = 0; i < run.count; ++i, nodes += run.nodesPerCell)
      for (std::size_t m = 0; m < kind.middles.size(); ++m, ++checked) {
        std::vector<double> distances;
        for (const std::vector<int>& set : kind.middles) {
          double sum = 0;
          for (std::size_t k = 0; k < 3; ++k) {
            double d = mesh.points[nodes[kind.corners.size() + m]][k];
            for (const int c : set)
              d -= mesh.points[nodes[c]][k] / static_cast<double>(set.size());
            sum += d * d;
          }
          distances.push_back(sum);
        }
        const auto nearest = std::min_element(distances.begin(), distances.end());
        ASSERT_EQ(static_cast<std::size_t>(nearest - distances.begin()), m) << kind.name;
      }
  }
  EXPECT_EQ(checked, 5u * 6 + 3 * 19 + 6 * 12);
}

// Abaqus' mids: below, above, between; those of VTK.
TEST(NodeOrder, Abaqus) {
  for (const auto& [name, type] :
       {std::pair("tet10", "C3D10"), std::pair("hex20", "C3D20R"), std::pair("wedge15", "C3D15")}) {
    const auto& kind = kindOf(name);
    const std::vector<Vec3d> points = cellPoints(kind, kind.middles);
    const std::string all = numbersTo(points.size(), ", ");
    // Twenty nodes take two lines.
    const std::size_t half = all.find(", ", all.size() / 2);
    expectVtkOrder(readText(readAbaqus, "*NODE\n" + rowsOf(points, true, ", ") + "*ELEMENT, TYPE=" +
                                            type + "\n1, " + all.substr(0, half + 1) + "\n" +
                                            all.substr(half + 2) + "\n"),
                   kind);
  }
}

// Exodus' mids of hexahedra and wedges: below, between, above; then the cell, the faces below,
// above, left, right, in front, behind.
TEST(NodeOrder, Exodus) {
  const Sets below{{0, 1}, {1, 2}, {2, 3}, {3, 0}}, between{{0, 4}, {1, 5}, {2, 6}, {3, 7}},
      above{{4, 5}, {5, 6}, {6, 7}, {7, 4}},
      middles{{0, 1, 2, 3, 4, 5, 6, 7},
              {0, 1, 2, 3},
              {4, 5, 6, 7},
              {0, 3, 4, 7},
              {1, 2, 5, 6},
              {0, 1, 4, 5},
              {2, 3, 6, 7}};
  const auto joined = [](std::initializer_list<Sets> all) {
    Sets sets;
    for (const Sets& some : all)
      sets.insert(sets.end(), some.begin(), some.end());
    return sets;
  };
  struct Case {
    const char *name, *type;
    Sets sets;
  };
  const Case cases[] = {{"tet10", "TETRA10", kindOf("tet10").middles},
                        {"hex20", "HEX20", joined({below, between, above})},
                        {"hex27", "HEX27", joined({below, between, above, middles})},
                        {"wedge15",
                         "WEDGE15",
                         {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 4}, {2, 5}, {3, 4}, {4, 5}, {5, 3}}},
                        {"pyramid13", "PYRAMID13", kindOf("pyramid13").middles}};
  for (const Case& one : cases) {
    const auto& kind = kindOf(one.name);
    const std::vector<Vec3d> points = cellPoints(kind, one.sets);
    const std::string path = testing::TempDir() + "tetvdb_order_" + std::to_string(::getpid());
    int file = 0, dims = 0, count = 0, blocks = 0, cells = 0, nodes = 0, coordinates[3],
        connect = 0;
    ASSERT_EQ(nc_create(path.c_str(), NC_CLOBBER, &file), NC_NOERR);
    nc_def_dim(file, "num_dim", 3, &dims);
    nc_def_dim(file, "num_nodes", points.size(), &count);
    nc_def_dim(file, "num_el_blk", 1, &blocks);
    nc_def_dim(file, "num_el_in_blk1", 1, &cells);
    nc_def_dim(file, "num_nod_per_el1", points.size(), &nodes);
    for (int k = 0; k < 3; ++k)
      nc_def_var(file, (std::string("coord") + "xyz"[k]).c_str(), NC_DOUBLE, 1, &count,
                 &coordinates[k]);
    const int shape[2] = {cells, nodes};
    nc_def_var(file, "connect1", NC_INT, 2, shape, &connect);
    nc_put_att_text(file, connect, "elem_type", std::string(one.type).size(), one.type);
    nc_enddef(file);
    std::vector<int> numbers;
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<double> values;
      for (const Vec3d& p : points)
        values.push_back(p[k]);
      nc_put_var_double(file, coordinates[k], values.data());
    }
    for (std::size_t i = 0; i < points.size(); ++i)
      numbers.push_back(static_cast<int>(i + 1));
    nc_put_var_int(file, connect, numbers.data());
    ASSERT_EQ(nc_close(file), NC_NOERR);
    expectVtkOrder(readText(readExodus, readFile(path)), kind);
    std::remove(path.c_str());
  }
}

// Formats that leave the order open: found from where the nodes lie, whatever it is.
class OpenOrder : public ::testing::Test {
protected:
  static Sets order(int round) {
    Sets sets = kindOf("tet10").middles;
    for (int i = 0; i < round; ++i)
      std::next_permutation(sets.begin(), sets.end());
    if (round % 2 == 1)
      std::reverse(sets.begin(), sets.end());
    return sets;
  }
};

TEST_F(OpenOrder, Netgen) {
  for (int round = 0; round < 50; ++round) {
    const std::vector<Vec3d> points = cellPoints(kindOf("tet10"), order(round));
    expectVtkOrder(readText(readNetgen, "mesh3d\nvolumeelements\n1\n1 10 " + numbersTo(10, " ") +
                                            "\npoints\n10\n" + rowsOf(points, false, " ") +
                                            "endmesh\n"),
                   kindOf("tet10"));
  }
}

TEST_F(OpenOrder, TetGen) {
  for (int round = 0; round < 50; ++round) {
    const std::vector<Vec3d> points = cellPoints(kindOf("tet10"), order(round));
    const std::string node = "10 3 0 0\n" + rowsOf(points, true, " ");
    const std::string ele = "1 10 0\n1 " + numbersTo(10, " ") + "\n";
    Report report;
    Progress progress;
    expectVtkOrder(
        readTetGenPair(Source{node, "a.node"}, Source{ele, "a.ele"}, {}, report, progress),
        kindOf("tet10"));
  }
}

TEST_F(OpenOrder, Medit) {
  for (int round = 0; round < 50; ++round) {
    const std::vector<Vec3d> points = cellPoints(kindOf("tet10"), order(round));
    std::string vertices = rowsOf(points, false, " ");
    for (std::size_t at = 0; (at = vertices.find('\n', at)) != std::string::npos; at += 3)
      vertices.replace(at, 1, " 0\n");
    expectVtkOrder(readText(readMedit, "MeshVersionFormatted 2\nDimension 3\nVertices\n10\n" +
                                           vertices + "TetrahedraP2\n1\n" + numbersTo(10, " ") +
                                           " 1\nEnd\n"),
                   kindOf("tet10"));
  }
}

TEST_F(OpenOrder, MidsWithoutAnOrderAreDropped) {
  CellMesh mesh;
  mesh.points = cellPoints(kindOf("tet10"), order(0));
  mesh.nodes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 1, 2, 3, 5, 4, 6, 7, 8, 9};
  mesh.runs.push_back({CellType::Tetra, 10, 2, "tetra10", true});
  orderMids(mesh);
  EXPECT_EQ(mesh.runs[0].nodesPerCell, 4u);
  EXPECT_EQ(mesh.nodes, (std::vector<std::uint32_t>{0, 1, 2, 3, 0, 1, 2, 3}));
  EXPECT_TRUE(mesh.runs[0].quadratic);
}

} // namespace
} // namespace tetvdb
