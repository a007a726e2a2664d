// SPDX-License-Identifier: Apache-2.0
#include "io/BlockSample.h"
#include "tetvdb/io/TriangleReader.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/formats/vtk/VtkReader.h"

#include <cmath>

namespace tetvdb {
namespace {

using namespace test;

/// Six times the volume that the faces enclose.
double enclosed(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    const Vec3d &a = mesh.points[mesh.triangles[3 * t]],
                &b = mesh.points[mesh.triangles[3 * t + 1]],
                &c = mesh.points[mesh.triangles[3 * t + 2]];
    sum += sixfoldVolume({0, 0, 0}, a, b, c);
  }
  return sum;
}

TEST(CellFaces, PolygonsOfVtkFiles) {
  double volume = 0;
  for (const char* name : {"sphere_ascii.vtp", "sphere_raw.vtp", "strips.vtp", "sphere.vtk",
                           "strips.vtk", "sphere.vtu"}) {
    Report report;
    Progress progress;
    const TriangleMesh mesh =
        readTriangles(dataFile(std::string("readers/") + name), report, progress);
    EXPECT_TRUE(report.warnings.empty()) << name;
    EXPECT_EQ(mesh.triangleCount(), 144U) << name;
    if (volume == 0)
      volume = enclosed(mesh);
    EXPECT_GT(volume, 0.8 * 6 * 0.5) << name; // nearly that of the sphere of radius 1/2, 0.5236
    EXPECT_NEAR(enclosed(mesh), volume, 1e-5) << name;
    const MappedFile file(dataFile(std::string("readers/") + name));
    EXPECT_TRUE(holdsTriangles(file.source(), progress)) << name;
  }
  Progress progress;
  for (const char* name : {"vtk/mixed_binary_42.vtk", "vtk/mixed_ascii_51.vtk",
                           "vtk/mixed_base64_zlib_32_little.vtu", "readers/block.vtkhdf"}) {
    const MappedFile file(dataFile(name));
    EXPECT_FALSE(holdsTriangles(file.source(), progress)) << name;
  }
}

TEST(CellFaces, KindsOfPolygons) {
  ReadOptions options;
  options.faces = true;
  const std::string text =
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 float\n0 0 0 1 0 "
      "0 1 "
      "1 0 0 1 0 2 0 0 2 1 0\nCELLS 5 23\n4 0 1 3 2\n4 0 1 2 3\n5 0 1 4 5 2\n4 0 1 3 2\n1 0\n"
      "CELL_TYPES 5\n8\n9\n7\n6\n1\n";
  const TriangleMesh mesh = trianglesOfFaces(readText(readVtk, text, nullptr, options), "file");
  EXPECT_EQ(mesh.triangles, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3,          // pixel
                                                        0, 1, 2, 0, 2, 3,          // quad
                                                        0, 1, 4, 0, 4, 5, 0, 5, 2, // polygon
                                                        0, 1, 3, 1, 2, 3}));       // strip
}

TEST(CellFaces, SolidCellsAndPointsAreRefused) {
  CellMesh solid;
  solid.points.resize(4);
  solid.nodes = {0, 1, 2, 3};
  solid.runs.push_back({CellType::Tetra, 4, 1, "tetra"});
  EXPECT_TRUE(hasSolidCells(solid));
  EXPECT_FALSE(hasPolygons(solid));
  EXPECT_THROW(trianglesOfFaces(std::move(solid), "file"), Error);
  CellMesh points;
  points.points.resize(1);
  points.runs.push_back({CellType::Flat, 0, 1, "vertex"});
  EXPECT_THROW(trianglesOfFaces(std::move(points), "file"), Error);
}

} // namespace
} // namespace tetvdb
