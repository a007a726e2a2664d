// SPDX-License-Identifier: Apache-2.0
//
// Damaged files end in an Error or in a mesh whose indices are right, and in nothing else.
#include "TestScale.h"
#include "io/ResultSamples.h"
#include "io/TriangleSamples.h"
#include "io/formats/openfoam/FoamSample.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/formats/abaqus/AbaqusReader.h"
#include "tetvdb/io/formats/avs/UcdReader.h"
#include "tetvdb/io/formats/calculix/FrdReader.h"
#include "tetvdb/io/formats/ensight/EnsightReader.h"
#include "tetvdb/io/formats/gambit/NeuReader.h"
#include "tetvdb/io/formats/gmsh/GmshReader.h"
#include "tetvdb/io/formats/ideas/UnvReader.h"
#include "tetvdb/io/formats/medit/MeditReader.h"
#include "tetvdb/io/formats/netgen/NetgenReader.h"
#include "tetvdb/io/formats/obj/ObjReader.h"
#include "tetvdb/io/formats/off/OffReader.h"
#include "tetvdb/io/formats/ply/PlyReader.h"
#include "tetvdb/io/formats/stl/StlReader.h"
#include "tetvdb/io/formats/su2/Su2Reader.h"
#include "tetvdb/io/formats/tetgen/TetGenReader.h"
#include "tetvdb/io/formats/threemf/ThreeMfModel.h"
#include "tetvdb/io/formats/vtk/VtkHdfReader.h"
#include "tetvdb/io/formats/vtk/VtkReader.h"
#include "tetvdb/io/formats/vtk/VtuReader.h"

#include <chrono>
#include <functional>
#include <random>

namespace tetvdb {
namespace {

using namespace test;
using Consume = std::function<void(const std::string&)>;

std::string mutated(std::string bytes, std::mt19937& random) {
  const auto place = [&] { return random() % bytes.size(); };
  switch (random() % 6) {
  case 0:
    bytes.resize(place());
    break; // cut off
  case 1:
    bytes.erase(place(), 1 + random() % 20);
    break;
  case 2: // a large number in place of another
    if (const std::size_t at = bytes.find_first_of("0123456789", place()); at != bytes.npos)
      bytes.replace(at, 1, random() % 2 == 0 ? "4294967295" : "-7");
    break;
  case 3: { // a piece twice
    const std::size_t at = place();
    bytes.insert(at, bytes.substr(at, 1 + random() % 200));
    break;
  }
  default:
    for (std::size_t n = 1 + random() % 4; n > 0; --n)
      bytes[place()] = static_cast<char>(random());
  }
  return bytes;
}

void attack(const std::string& bytes, int times, const Consume& consume) {
  ASSERT_FALSE(bytes.empty());
  std::mt19937 random(20);
  for (int i = 0; i < times / kSlower + 1; ++i) {
    const std::string damaged = mutated(bytes, random);
    const auto start = std::chrono::steady_clock::now();
    try {
      consume(damaged);
    } catch (const Error& error) {
      ASSERT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos) << error.what();
    }
    const auto taken = std::chrono::steady_clock::now() - start;
    ASSERT_LT(taken, std::chrono::seconds(5 * kSlower)) << "mutant " << i;
  }
}

Consume with(ReadFunction read) {
  return [read](const std::string& bytes) {
    const CellMesh mesh = readText(read, bytes);
    for (const std::uint32_t node : mesh.nodes)
      ASSERT_LT(node, mesh.points.size());
    for (const Vec3d& p : mesh.points)
      ASSERT_TRUE(std::isfinite(p[0] + 0 * p[1] + 0 * p[2]));
    ASSERT_TRUE(mesh.regions.empty() || mesh.regions.size() == mesh.cellCount());
    for (const Attribute& attribute : mesh.attributes)
      ASSERT_EQ(attribute.size(),
                attribute.on == Attribute::On::Cells ? mesh.cellCount() : mesh.points.size());
    splitAll(mesh);
  };
}

constexpr int kSmall = 3000;
constexpr int kLarge = 300;

TEST(Mutations, Gmsh) {
  for (const char* text : {kGmsh1, kGmsh2, kGmsh40, kGmsh41})
    attack(text, kSmall, with(readGmsh));
  for (const bool swap : {false, true})
    for (const std::string& bytes : {gmshBinary2(swap), gmshBinary40(swap), gmshBinary41(swap)})
      attack(bytes, kSmall, with(readGmsh));
  for (const char* name : {"table.msh", "quadratic_sphere_tet.msh", "hybrid_tetwedge.msh",
                           "malformed_missing_node.msh"})
    attack(readFile(dataFile(name)), kLarge, with(readGmsh));
}

TEST(Mutations, Medit) {
  attack(kMedit, kSmall, with(readMedit));
  for (const int version : {1, 2, 3, 4})
    for (const bool swap : {false, true})
      attack(meditBinary(version, swap), kSmall, with(readMeditBinary));
  attack(readFile(dataFile("quadcopter_frame.mesh")), kLarge, with(readMedit));
}

TEST(Mutations, TetGen) {
  const auto pair = [](const std::string& node, const std::string& ele) {
    Report report;
    Progress progress;
    splitAll(readTetGenPair({node, "a.node"}, {ele, "a.ele"}, {}, report, progress));
  };
  attack(kNode, kSmall, [&](const std::string& bytes) { pair(bytes, kEle); });
  attack(kEle, kSmall, [&](const std::string& bytes) { pair(kNode, bytes); });
  const std::string node = readFile(dataFile("octahedron.node"));
  const std::string ele = readFile(dataFile("octahedron.ele"));
  attack(node, kLarge, [&](const std::string& bytes) { pair(bytes, ele); });
  attack(ele, kLarge, [&](const std::string& bytes) { pair(node, bytes); });
}

TEST(Mutations, Netgen) {
  attack(kNetgen, kSmall, with(readNetgen));
}

TEST(Mutations, Abaqus) {
  attack(kAbaqus, kSmall, with(readAbaqus));
  attack(readFile(dataFile("abaqus_tet.inp")), kSmall, with(readAbaqus));
}

TEST(Mutations, Ucd) {
  attack(kUcd, kSmall, with(readUcd));
  attack(readFile(dataFile("cellsnd.ascii.inp")), kSmall, with(readUcd));
  for (const bool swap : {false, true})
    attack(ucdBinary(swap), kSmall, with(readUcd));
}

Consume with(ReadTriangles read) {
  return [read](const std::string& bytes) {
    const Reading got = reading(read, bytes); // expects what every mesh must hold to
    ASSERT_TRUE(got.error.empty() || got.status == Status::Invalid || got.status == Status::Limit);
    ASSERT_EQ(got.mesh.triangles.size() % 3, 0U);
    // A point takes two characters in text and three bytes in binary at least.
    ASSERT_LE(got.mesh.points.size(), bytes.size());
    ASSERT_LE(got.mesh.triangles.size(), 3 * bytes.size());
  };
}

const std::string kObj = "# a\nmtllib a.mtl\no a\nv 0 0 0 1 0.5 0.5\nv 1 0 0\nvt 0 1\nvn 0 0 1\n"
                         "v 0 1 0 \\\n1\nv 0 0 1\nf 1/1/1 3/1/1 2/1/1\nf -4 -3 -1\ns 1\n"
                         "f 1//1 4//1 3//1\nf 2 3 4 1\n";

TEST(Mutations, Triangles) {
  const std::string facets =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\nendloop\n"
      "endfacet\n";
  attack("solid a\n" + facets + facets + "endsolid a\nsolid b\n" + facets + "endsolid\n", kSmall,
         with(readStl));
  attack(Bytes()
             .text(std::string(80, ' '))
             .ints({2})
             .text(std::string(50, '\1') + std::string(50, '\2'))
             .str(),
         kSmall, with(readStl));
  attack(kObj, kSmall, with(readObj));
  attack("COFF\n4 3 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 0 0 0 0\n0 0 1 0 0 0 0\n3 0 1 2 1 0 0\n"
         "4 0 1 2 3\n# c\n3 1 2 3\n",
         kSmall, with(readOff));
  attack("OFF BINARY\n" + Bytes(true)
                              .ints({3, 1, 3})
                              .floats({0, 0, 0, 1, 0, 0, 0, 1, 0})
                              .ints({3, 0, 1, 2, 0})
                              .str(),
         kSmall, with(readOff));
  const auto header = [](const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\ncomment c\nelement vertex 3\nproperty float x\nproperty float y\n"
           "property float z\nproperty uchar red\nelement face 1\nproperty list uchar int "
           "vertex_indices\nelement tristrips 1\nproperty list int int "
           "vertex_indices\nend_header\n";
  };
  attack(header("ascii") + "0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2\n5 0 1 2 -1 0\n", kSmall,
         with(readPly));
  for (const bool big : {false, true}) {
    Bytes bytes(big);
    bytes.text(header(big ? "binary_big_endian" : "binary_little_endian"));
    for (const float x : {0.0F, 1.0F, 2.0F})
      bytes.floats({x, x * x, 0}).add<std::uint8_t>({1});
    bytes.add<std::uint8_t>({3}).ints({0, 1, 2}).ints({5, 0, 1, 2, -1, 0});
    attack(bytes.str(), kSmall, with(readPly));
  }
}

TEST(Mutations, ThreeMfModels) {
  attack(
      "<?xml version=\"1.0\"?><model unit='inch'><!-- c --><resources><object "
      "id='1'><mesh><vertices>"
      "<vertex x='0' y='1e3' z='-2'/><vertex x='1' y='0' z='0'/></vertices><triangles><triangle "
      "v1='0' v2='1' v3='1'/></triangles></mesh></object><object id='2'><components><component "
      "objectid='1' p:path='/a.model' transform='1 0 0 0 1 0 0 0 1 5 6 7'/></components></object>"
      "</resources><build><item objectid='2'/></build></model>",
      kSmall, [](const std::string& bytes) {
        Progress progress;
        const ThreeMfModel model = parseThreeMfModel(bytes, "file", progress);
        for (const auto& [id, object] : model.objects)
          ASSERT_EQ(object.triangles.size() % 3, 0U);
      });
}

TEST(Mutations, Results) {
  for (const int form : {0, 1, 2, 3})
    attack(frdFile(form), kSmall, [&](const std::string& bytes) {
      with(readFrd)(bytes);
      Report report;
      Progress progress;
      frdTimes({bytes, "file"}, report, progress);
    });
  for (const bool byRows : {false, true})
    attack(neuFile(byRows), kSmall, with(readNeu));
  attack(su2File(), kSmall, with(readSu2));
  attack(unvFile(), kSmall, with(readUnv));
  for (const FoamForm& form : {FoamForm{}, FoamForm{true, 8, 4, true}})
    attack(foamTexts(form), kSmall, [](const std::string& bytes) {
      Report report;
      Progress progress;
      splitAll(openfoam::readTexts(bytes, report, progress));
    });
  const auto readPart = [](const std::string& bytes) {
    Progress progress;
    const CellMesh mesh = ensight::readGeometry({bytes, "file"}, {}, progress);
    for (const Vec3d& p : mesh.points)
      ASSERT_TRUE(std::isfinite(p[0] + 0 * p[1] + 0 * p[2]));
    splitAll(mesh);
  };
  attack(readFile(dataFile("readers/ensight.0.00000.geo")), kSmall, readPart);
  attack(
      "a\nb\nnode id given\nelement id off\npart\n1\nx\ncoordinates\n4\n1\n2\n3\n4\n0\n1\n0\n0"
      "\n0\n0\n1\n0\n0\n0\n0\n1\ntetra4\n1\n1 2 3 4\nnfaced\n1\n4\n3\n3\n3\n3\n1 2 3\n1 4 2\n2 4 "
      "3\n1 3 4\nnsided\n1\n3\n1 2 3\n",
      kSmall, readPart);
  attack("FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: 1 a*.geo\nVARIABLE\nscalar per node: 1 T "
         "t*.scl\nTIME\ntime set: 1\nnumber of steps: 2\nfilename start number: 0\nfilename "
         "increment: 1\ntime values: 0.5 1.5\n",
         kSmall, [](const std::string& bytes) {
           Report report;
           Progress progress;
           ensightTimes({bytes, "file"}, report, progress);
         });
}

TEST(Mutations, Polygons) {
  for (const char* name : {"sphere_ascii.vtp", "sphere_raw.vtp", "strips.vtp", "strips.vtk"})
    attack(readFile(dataFile(std::string("readers/") + name)), kSmall / 4,
           [](const std::string& bytes) {
             ReadOptions options;
             options.faces = true;
             Report report;
             Progress progress;
             const bool isXml = bytes.find("VTKFile") != bytes.npos;
             const TriangleMesh mesh = trianglesOfFaces(
                 (isXml ? readVtu : readVtk)({bytes, "file"}, options, report, progress), "file");
             for (const std::uint32_t corner : mesh.triangles)
               ASSERT_LT(corner, mesh.points.size());
           });
}

// Each in a process of its own.
TEST(Mutations, Hdf5) {
  for (const char* name : {"block.vtkhdf", "steps.vtkhdf", "surface.vtkhdf"})
    attack(readFile(dataFile(std::string("readers/") + name)), 60,
           [](const std::string& bytes) { splitAll(readText(readVtkHdf, bytes)); });
}

TEST(Mutations, Sniffing) {
  for (const std::string& bytes : {std::string(kGmsh2), std::string(kUcd), meditBinary(2, false),
                                   std::string("<VTKFile type=\"UnstructuredGrid\">"), kObj})
    for (const char* path : {"a.inp", "a.msh", "a", "a.mesh"})
      attack(bytes, 300, [&](const std::string& damaged) {
        sniffFormat(damaged, path);
        describeUnknownFormat(damaged, path);
      });
}

} // namespace
} // namespace tetvdb
