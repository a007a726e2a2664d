// SPDX-License-Identifier: Apache-2.0
#include "io/TriangleSamples.h"
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/formats/amf/AmfReader.h"
#include "tetvdb/io/text/ZipWriter.h"

#include <cmath>

namespace tetvdb {
namespace {

using namespace test;

std::string vertex(const std::string& x, const std::string& y, const std::string& z) {
  return "<vertex><coordinates><x>" + x + "</x><y> " + y + "\n</y><z>" + z +
         "</z></coordinates><normal><nx>1</nx></normal></vertex>";
}

std::string triangle(int a, int b, int c) {
  return "<triangle><v1>" + std::to_string(a) + "</v1><v2>" + std::to_string(b) + "</v2><v3>" +
         std::to_string(c) + "</v3></triangle>";
}

// The corner tetrahedron, in two volumes.
std::string object(int id) {
  return "<object id=\"" + std::to_string(id) +
         "\"><metadata type=\"name\">part</metadata><mesh><vertices>" + vertex("0", "0", "0") +
         vertex("1e0", "0", "0") + vertex("0", "+1.0", "0") + vertex("0", "0", "1") +
         "</vertices><volume materialid=\"2\">" + triangle(0, 2, 1) + triangle(0, 1, 3) +
         "</volume><volume><color><r>1</r></color>" + triangle(0, 3, 2) + triangle(1, 2, 3) +
         "</volume></mesh></object>";
}

std::string amf(const std::string& content, const std::string& unit = "") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- <object> -->\n<amf" +
         (unit.empty() ? "" : " unit=\"" + unit + "\"") + " version=\"1.1\">" + content +
         "</amf>\n";
}

std::string constellation(int id, const std::string& instances) {
  return "<constellation id=\"" + std::to_string(id) + "\">" + instances + "</constellation>";
}

std::string instance(int object, const std::string& placement) {
  return "<instance objectid=\"" + std::to_string(object) + "\">" + placement + "</instance>";
}

void expectPoint(const Vec3d& p, const Vec3d& expected) {
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(p[k], expected[k], 1e-12) << k;
}

TEST(AmfReader, ObjectsWithoutConstellations) {
  const Reading one = reading(readAmf, amf(object(7), "inch"));
  ASSERT_EQ(one.error, "");
  EXPECT_EQ(one.mesh.points, cornerTetrahedron().points);
  EXPECT_EQ(one.mesh.triangles, cornerTetrahedron().triangles);
  EXPECT_EQ(one.mesh.units, "inch");
  EXPECT_EQ(one.codes(), "");
  const Reading two = reading(readAmf, amf(object(1) + object(2)));
  EXPECT_EQ(two.mesh.triangleCount(), 8U);
  EXPECT_EQ(two.mesh.units, "millimetre");
}

TEST(AmfReader, ConstellationsPlaceObjects) {
  // Scaled by 2, turned by 90 degrees about x and then z, moved: x -> y, y -> z, z -> x.
  const std::string placement =
      "<deltax>10</deltax><deltay>20</deltay><deltaz>30</deltaz><rx>90</rx>"
      "<rz>90</rz><scale>2</scale>";
  const Reading turned =
      reading(readAmf, amf(object(1) + constellation(2, instance(1, placement))));
  ASSERT_EQ(turned.error, "");
  ASSERT_EQ(turned.mesh.points.size(), 4U);
  expectPoint(turned.mesh.points[0], {10, 20, 30});
  expectPoint(turned.mesh.points[1], {10, 22, 30});
  expectPoint(turned.mesh.points[2], {10, 20, 32});
  expectPoint(turned.mesh.points[3], {12, 20, 30});

  // A mirrored one stays oriented outward; one within another is placed by both.
  const Reading nested = reading(
      readAmf,
      amf(object(1) + constellation(2, instance(1, "<mirrorx>-1</mirrorx>")) +
          constellation(3, instance(2, "<deltax>5</deltax>") + instance(1, "") + instance(9, ""))));
  ASSERT_EQ(nested.error, "");
  EXPECT_EQ(nested.codes(), "missing-objects");
  ASSERT_EQ(nested.mesh.triangleCount(), 8U);
  expectPoint(nested.mesh.points[1], {4, 0, 0});
  for (std::size_t part = 0; part < 2; ++part) {
    double volume = 0;
    for (std::size_t t = 4 * part; t < 4 * part + 4; ++t) {
      const Vec3d &a = nested.mesh.points[nested.mesh.triangles[3 * t]],
                  &b = nested.mesh.points[nested.mesh.triangles[3 * t + 1]],
                  &c = nested.mesh.points[nested.mesh.triangles[3 * t + 2]];
      volume += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    EXPECT_NEAR(volume, 1, 1e-12) << part;
  }
}

TEST(AmfReader, File) {
  Report report;
  Progress progress;
  const TriangleMesh mesh = readTriangles(dataFile("readers/placed.amf"), report, progress);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(mesh.triangleCount(), 8U);
  EXPECT_EQ(mesh.units, "inch");
  expectPoint(mesh.points[1], {2, 1, 1});
  expectPoint(mesh.points[5], {3, 0, 0});
}

TEST(AmfReader, Archives) {
  const TemporaryPath path("archive.amf");
  {
    AtomicFile file(path.str());
    ZipWriter zip(file);
    zip.begin("part.amf");
    zip.write(amf(object(1)));
    zip.end();
    zip.finish();
    file.commit();
  }
  for (const std::string& bytes : {readFile(path.str()), amf(object(1))}) {
    FileFormat format = FileFormat::Unknown;
    const Reading read = readingFile("part.zip", bytes, &format);
    EXPECT_EQ(format, FileFormat::Amf);
    EXPECT_EQ(read.mesh.triangles, cornerTetrahedron().triangles);
  }
}

TEST(AmfReader, Faults) {
  const Reading bad =
      reading(readAmf, amf("<object id=\"1\"><mesh><vertices>" + vertex("0", "0", "0") +
                           vertex("1", "0", "0") + vertex("0", "1", "0") +
                           vertex("0", "zero", "1") + "</vertices><volume>" + triangle(0, 2, 1) +
                           triangle(0, 1, 9) + triangle(0, 1, 3) +
                           "<triangle><v1>0</v1><v2>1</v2></triangle></volume></mesh></object>"));
  EXPECT_EQ(bad.error, "");
  EXPECT_EQ(bad.mesh.triangleCount(), 1U);
  EXPECT_EQ(bad.codes(), "bad-vertices bad-faces");
  for (const std::string& text :
       {amf(""), std::string("<amf>"), amf("<object id=\"1\"><mesh></object>"),
        amf(object(1) + constellation(2, instance(1, "<rx>nan</rx>"))), std::string("<model/>"),
        std::string("PK\x03\x04")}) {
    const Reading read = reading(readAmf, text);
    EXPECT_EQ(read.status, Status::Invalid) << text;
    EXPECT_EQ(read.error.find("file"), 0U) << read.error;
  }
  std::string doubling = object(1);
  for (int level = 2; level < 60; ++level)
    doubling += constellation(level, instance(level - 1, "") + instance(level - 1, ""));
  EXPECT_EQ(reading(readAmf, amf(doubling)).status, Status::Limit);
}

} // namespace
} // namespace tetvdb
