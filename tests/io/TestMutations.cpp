// SPDX-License-Identifier: Apache-2.0
//
// Damaged files end in an Error or in a mesh whose indices are right, and in nothing else.
#include "io/MeshSamples.h"
#include "tetvdb/io/AbaqusReader.h"
#include "tetvdb/io/GmshReader.h"
#include "tetvdb/io/MeditReader.h"
#include "tetvdb/io/NetgenReader.h"
#include "tetvdb/io/TetGenReader.h"
#include "tetvdb/io/UcdReader.h"

#include <chrono>
#include <functional>
#include <random>

namespace tetvdb {
namespace {

using namespace test;
using Consume = std::function<void(const std::string&)>;

#ifdef TETVDB_SANITIZED
constexpr int kSlower = 10;
#else
constexpr int kSlower = 1;
#endif

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

TEST(Mutations, Sniffing) {
  for (const std::string& bytes : {std::string(kGmsh2), std::string(kUcd), meditBinary(2, false),
                                   std::string("<VTKFile type=\"UnstructuredGrid\">")})
    for (const char* path : {"a.inp", "a.msh", "a", "a.mesh"})
      attack(bytes, 300, [&](const std::string& damaged) {
        sniffMeshFormat(damaged, path);
        describeUnknownFormat(damaged, path);
      });
}

} // namespace
} // namespace tetvdb
