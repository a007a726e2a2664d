// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "tetvdb/io/MeshReader.h"

#include <cstdio>
#include <unistd.h>

namespace tetvdb {
namespace {

using namespace test;
using Regions = std::vector<std::int32_t>;

class TemporaryFile {
public:
  TemporaryFile(const std::string& name, const std::string& text)
      : path_(testing::TempDir() + "tetvdb_" + std::to_string(::getpid()) + "_" + name) {
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~TemporaryFile() { std::remove(path_.c_str()); }
  const std::string& path() const { return path_; }

private:
  std::string path_;
};

CellMesh readNamed(const std::string& name, const std::string& text,
                   const ReadOptions& options = {}) {
  const TemporaryFile file(name, text);
  Report report;
  Progress progress;
  return readCells(file.path(), options, report, progress);
}

std::string namedError(const std::string& name, const std::string& text,
                       const ReadOptions& options = {}) {
  try {
    readNamed(name, text, options);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(MeshReader, FormatsAreToldByContent) {
  const auto sniff = [](const std::string& bytes, const char* path = "a") {
    return sniffFormat(bytes, path);
  };
  EXPECT_EQ(sniff(kGmsh1), FileFormat::Gmsh);
  EXPECT_EQ(sniff(std::string("\n") + kGmsh2), FileFormat::Gmsh);
  EXPECT_EQ(sniff(gmshBinary41(true)), FileFormat::Gmsh);
  EXPECT_EQ(sniff(kMedit, "wrong.msh"), FileFormat::Medit);
  EXPECT_EQ(sniff(std::string("# made by\n") + kMedit), FileFormat::Medit);
  EXPECT_EQ(sniff(meditBinary(3, true)), FileFormat::MeditBinary);
  EXPECT_EQ(sniff(kNode, "a.node"), FileFormat::TetGen);
  EXPECT_EQ(sniff(kEle, "a.ele"), FileFormat::TetGen);
  EXPECT_EQ(sniff(kNetgen), FileFormat::Netgen);
  EXPECT_EQ(sniff(kAbaqus, "a.inp"), FileFormat::Abaqus);
  EXPECT_EQ(sniff(kUcd, "a.inp"), FileFormat::Ucd);
  EXPECT_EQ(sniff(ucdBinary(false), "a.inp"), FileFormat::Ucd);
  EXPECT_EQ(sniff("# vtk DataFile Version 3.0\n"), FileFormat::Vtk);
  EXPECT_EQ(sniff("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\">"), FileFormat::Vtu);
  EXPECT_EQ(sniff("<VTKFile type=\"PUnstructuredGrid\">"), FileFormat::Pvtu);
  EXPECT_EQ(sniff("CDF\x02"), FileFormat::Exodus);
  EXPECT_EQ(sniff("\x89HDF\r\n\x1a\n"), FileFormat::Exodus);
  EXPECT_EQ(sniff(""), FileFormat::Unknown);
  EXPECT_EQ(sniff("solid cube\n", "a.stl"), FileFormat::Stl);
}

TEST(MeshReader, ReadsByContent) {
  EXPECT_NEAR(cellVolume(readNamed("a.xyz", kGmsh41)), 0.5, 1e-15);
  EXPECT_NEAR(cellVolume(readNamed("a.mesh", kMedit)), 2, 1e-15);
  EXPECT_NEAR(cellVolume(readNamed("a.inp", kUcd)), 4.0 / 3, 1e-15);
  EXPECT_NEAR(cellVolume(readNamed("b.inp", kAbaqus)), 0.5, 1e-15);
}

TEST(MeshReader, UnknownFilesAreDescribed) {
  const auto error = [](const std::string& name, const std::string& text) {
    return namedError(name, text);
  };
  EXPECT_NE(error("a.stl", "solid cube\n").find("holds triangles (STL)"), std::string::npos);
  EXPECT_NE(error("a.obj", "v 0 0 0\n").find("holds triangles (OBJ)"), std::string::npos);
  EXPECT_NE(error("a.ply", "ply\n").find("holds triangles (PLY)"), std::string::npos);
  EXPECT_NE(error("a.vdb", " BDV\x00").find("OpenVDB volume"), std::string::npos);
  EXPECT_NE(error("a.zip", "PK\x03\x04").find("ZIP"), std::string::npos);
  EXPECT_NE(error("a.gz", "\x1f\x8b").find("gzip"), std::string::npos);
  EXPECT_NE(error("a.msh", "(0 \"fluent\")").find("Fluent"), std::string::npos);
  EXPECT_NE(error("a.bin", std::string(100, '\x01')).find("binary data"), std::string::npos);
  EXPECT_NE(error("a.txt", "hello").find("text"), std::string::npos);
}

TEST(MeshReader, SurfacesAreRefusedWithTheirContent) {
  const std::string message =
      namedError("a.mesh", "MeshVersionFormatted 1\nDimension 3\nVertices 3\n0 0 0 0\n1 0 0 0\n"
                           "0 1 0 0\nTriangles 2\n1 2 3 0\n1 2 3 0\nEnd\n");
  EXPECT_NE(message.find("no tetrahedra or other solid cells; it holds 2 triangles"),
            std::string::npos)
      << message;
  EXPECT_NE(namedError("b.inp", readFile(dataFile("cellsnd.ascii.inp"))).find("8 triangles"),
            std::string::npos);
}

TEST(MeshReader, MissingFilesAndDirectories) {
  Report report;
  Progress progress;
  EXPECT_THROW(readCells("/no/such/file.msh", {}, report, progress), Error);
  EXPECT_THROW(readCells(testing::TempDir(), {}, report, progress), Error);
  EXPECT_NE(namedError("empty.msh", "").find("empty"), std::string::npos);
}

std::string withElementData(const std::string& name) {
  std::string text = kGmsh2;
  for (const char* tags : {"2 2 7 1", "4 2 3 1"}) { // no tags: regions come from elsewhere
    const std::size_t at = text.find(tags);
    text.replace(at, 7, std::string(tags, 1) + " 0");
  }
  const std::size_t at = text.find("4 4 4 2 1 5");
  text.replace(at, 11, "4 0");
  return text + "$ElementData\n1\n\"" + name +
         "\"\n0\n3\n0\n1\n3\n1 5\n5 6\n9 7\n$EndElementData\n";
}

TEST(MeshReader, RegionsFromAnArrayWithAUsualName) {
  for (const char* name : {"Material Ids", "region", "MAT_ID", "gmsh:physical"})
    EXPECT_EQ(readNamed("a.msh", withElementData(name)).regions, (Regions{5, 6, 7})) << name;
  EXPECT_TRUE(readNamed("a.msh", withElementData("pressure")).regions.empty());
}

TEST(MeshReader, RegionsFromTheArrayThatIsNamed) {
  ReadOptions options;
  options.regionArray = "pressure";
  EXPECT_EQ(readNamed("a.msh", withElementData("pressure"), options).regions, (Regions{5, 6, 7}));
  options.attributes = false;
  const CellMesh mesh = readNamed("a.msh", withElementData("pressure"), options);
  EXPECT_EQ(mesh.regions, (Regions{5, 6, 7}));
  EXPECT_TRUE(mesh.attributes.empty());
  EXPECT_NE(namedError("a.msh", withElementData("region"), options).find("'stress', 'region'"),
            std::string::npos);
  options.regionArray = "stress";
  EXPECT_NE(namedError("a.msh", kGmsh2, options).find("whole numbers"), std::string::npos);
}

TEST(MeshReader, CanBeCancelled) {
  const TemporaryFile file("big.mesh", readFile(dataFile("quadcopter_frame.mesh")));
  Report report;
  Progress progress;
  progress.cancel();
  try {
    splitCells(readCells(file.path(), {}, report, progress), {}, report, progress);
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Cancelled);
  }
}

} // namespace
} // namespace tetvdb
