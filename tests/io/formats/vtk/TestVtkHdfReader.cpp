// SPDX-License-Identifier: Apache-2.0
#include "io/BlockSample.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/formats/vtk/VtkHdfReader.h"

namespace tetvdb {
namespace {

using namespace test;

TEST(VtkHdfReader, PartsAndArrays) {
  const CellMesh mesh = readSample(readVtkHdf, "block.vtkhdf");
  expectBlocks(mesh, 2, "T", "C");
  const Attribute& v = arrayNamed(mesh, "V");
  EXPECT_EQ(v.components, 3U);
  for (std::size_t i = 0; i < 54; ++i)
    for (std::uint32_t k = 0; k < 3; ++k)
      EXPECT_EQ(v.number(i, k), mesh.points[i][k]);
}

TEST(VtkHdfReader, BytesInMemoryAreReadAsAFileIs) {
  const std::string bytes = readFile(dataFile("readers/block.vtkhdf"));
  EXPECT_EQ(readText(readVtkHdf, bytes).nodes, readSample(readVtkHdf, "block.vtkhdf").nodes);
}

TEST(VtkHdfReader, Steps) {
  expectBlocks(readSample(readVtkHdf, "steps.vtkhdf"), 2, "T", "C", 1000);
  ReadOptions options;
  options.timeStep = 0;
  expectBlocks(readSample(readVtkHdf, "steps.vtkhdf", options), 2, "T", "C");
  options.timeStep = 2;
  EXPECT_THROW(readSample(readVtkHdf, "steps.vtkhdf", options), Error);
  Report report;
  Progress progress;
  const MappedFile steps(dataFile("readers/steps.vtkhdf")), plain(dataFile("readers/block.vtkhdf"));
  EXPECT_EQ(vtkHdfTimes(steps.source(), report, progress), (std::vector<double>{0.5, 2}));
  EXPECT_TRUE(vtkHdfTimes(plain.source(), report, progress).empty());
}

TEST(VtkHdfReader, Polygons) {
  ReadOptions options;
  options.faces = true;
  const TriangleMesh mesh =
      trianglesOfFaces(readSample(readVtkHdf, "surface.vtkhdf", options), "file");
  EXPECT_EQ(mesh.triangles, (std::vector<std::uint32_t>{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}));
  EXPECT_EQ(mesh.points[1], (Vec3d{2, 0, 0}));
}

TEST(VtkHdfReader, DamagedFilesAreErrors) {
  const std::string bytes = readFile(dataFile("readers/block.vtkhdf"));
  EXPECT_NE(readingError(readVtkHdf, bytes.substr(0, bytes.size() / 2)), "");
  EXPECT_NE(readingError(readVtkHdf, "\x89HDF\r\n\x1a\n"), "");
  std::string other = bytes;
  for (std::size_t at = 0; (at = other.find("UnstructuredGrid", at)) != other.npos; ++at)
    other.replace(at, 16, "OverlappingAMR\0\0", 16);
  EXPECT_NE(readingError(readVtkHdf, other).find("OverlappingAMR"), std::string::npos);
}

} // namespace
} // namespace tetvdb
