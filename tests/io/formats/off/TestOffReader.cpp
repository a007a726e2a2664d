// SPDX-License-Identifier: Apache-2.0
#include "io/TriangleSamples.h"
#include "tetvdb/io/formats/off/OffReader.h"

namespace tetvdb {
namespace {

using namespace test;

const std::string kPoints = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
const std::string kFaces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

void expectOffTetrahedron(const Reading& read, const std::string& codes = "") {
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.points, cornerTetrahedron().points);
  EXPECT_EQ(read.mesh.triangles, cornerTetrahedron().triangles);
  EXPECT_EQ(read.mesh.faceCount, 4U);
  EXPECT_EQ(read.codes(), codes);
}

TEST(OffReader, EveryHeader) {
  for (const char* head :
       {"OFF\n4 4 6\n", "OFF 4 4 6\n", "OFF4 4 6\n", "OFF4 4\n", "OFF 4 4\n", "OFF\n4 4\n",
        "off\n4 4 0\n", "# a comment\n#\nOFF # here\n# there\n4 4 6 # counts\n\n", "4 4 6\n",
        "OFF\n4\n4\n6\n", "OFF\n\n4 4 0\n", "\xef\xbb\xbfOFF\n4 4 6\n"}) {
    SCOPED_TRACE(head);
    expectOffTetrahedron(reading(readOff, head + kPoints + kFaces));
  }
}

TEST(OffReader, LineEnds) {
  std::string text = "OFF\n4 4 6\n" + kPoints + kFaces;
  for (char& c : text)
    c = c == '\n' ? '\r' : c;
  expectOffTetrahedron(reading(readOff, text));
  for (std::size_t at = 0; (at = text.find('\r', at)) != text.npos; at += 2)
    text.insert(at + 1, "\n");
  expectOffTetrahedron(reading(readOff, text));
}

TEST(OffReader, ColoursNormalsAndTextures) {
  const std::string points =
      "0 0 0 .1 .2 .3 1\n1 0 0 .1 .2 .3 1\n0 1 0 .1 .2 .3 1\n0 0 1 1 1 1 1\n";
  const std::string faces = "3 0 2 1 255 0 0\n3 0 1 3\n3  0 3 2  0.5 0.5 0.5 1 # red\n3 1 2 3 7\n";
  for (const char* keyword : {"COFF", "NOFF", "CNOFF", "STOFF", "STCNOFF", "OFF"})
    expectOffTetrahedron(reading(readOff, keyword + ("\n4 4 0\n" + points + faces)));
}

TEST(OffReader, EverythingOnOneLine) {
  expectOffTetrahedron(
      reading(readOff, "OFF 4 4 6 0 0 0 1 0 0 0 1 0 0 0 1 3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 3"));
  expectOffTetrahedron(reading(readOff,
                               "OFF\n4 4 6\n0 0 0 1 0 0 0 1 0 0 0 1\n3 0 2 1 3 0 1 3 3 0 3 2 "
                               "3 1 2 3\n"));
}

TEST(OffReader, PolygonsAreFans) {
  const Reading read = reading(readOff, "OFF\n4 1 0\n" + kPoints + "4 3 2 1 0\n");
  EXPECT_EQ(read.mesh.triangles, (Indices{3, 2, 1, 3, 1, 0}));
  EXPECT_EQ(read.mesh.faceCount, 1U);
}

TEST(OffReader, FacesWithoutMeaningAreLeftOut) {
  for (const char* bad : {"3 0 1 4\n", "3 0 1 -1\n", "2 0 1\n", "0\n", "x 0 1 2\n", "-3 0 1 2\n",
                          "3 0 1 x\n", "1000000 0 1 2\n", "3 0 1 1.5\n"}) {
    const Reading read = reading(readOff, "OFF\n4 5 0\n" + kPoints + bad + kFaces);
    expectOffTetrahedron(read, "bad-faces");
    EXPECT_TRUE(read.report.partial) << bad;
  }
}

TEST(OffReader, UnreadableVerticesKeepTheirPlace) {
  const Reading read =
      reading(readOff, "OFF\n5 4 0\n" + kPoints + "nan 0 x\n" + kFaces.substr(0, 24) + "3 0 1 4\n");
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.points.size(), 5U);
  EXPECT_EQ(read.mesh.triangleCount(), 3U);
  EXPECT_EQ(read.codes(), "bad-vertices bad-faces");
}

TEST(OffReader, CutOffKeepsWholeFaces) {
  const std::string text = "OFF\n4 5 0\n" + kPoints + kFaces;
  expectOffTetrahedron(reading(readOff, text), "truncated");
  expectOffTetrahedron(reading(readOff, text.substr(0, text.size() - 1)), "truncated");
  EXPECT_EQ(reading(readOff, text.substr(0, text.size() - 3)).mesh.triangleCount(), 3U);
  // "1" may be what is left of "17".
  std::string many = "OFF\n20 5 0\n";
  for (int i = 0; i < 20; ++i)
    many += "0 0 " + std::to_string(i) + "\n";
  EXPECT_EQ(reading(readOff, many + "3 0 1 2\n3 3 4 1").mesh.triangleCount(), 1U);
  EXPECT_EQ(reading(readOff, many + "3 0 1 2\n3 3 4 17").mesh.triangleCount(), 2U);
}

TEST(OffReader, CountsThatTheFileCannotHold) {
  EXPECT_NE(reading(readOff, "OFF\n353535235358 6 0\n" + kPoints + kFaces).error.find("declared"),
            std::string::npos);
  EXPECT_NE(reading(readOff, "OFF\n-4 4 0\n" + kPoints + kFaces).error, "");
  EXPECT_NE(reading(readOff, "OFF\n4 -4 0\n" + kPoints + kFaces).error, "");
  expectOffTetrahedron(reading(readOff, "OFF\n4 353535235358 0\n" + kPoints + kFaces), "truncated");
  EXPECT_NE(reading(readOff, "OFF\n9 4 0\n" + kPoints + kFaces).error, "");
  EXPECT_NE(reading(readOff, "OFF\n4 0 0\n" + kPoints).error.find("no faces"), std::string::npos);
  EXPECT_NE(reading(readOff, "4OFF\n4 4 0\n" + kPoints + kFaces).error.find("dimensions"),
            std::string::npos);
  EXPECT_NE(reading(readOff, "OFF").error, "");
}

TEST(OffReader, Binary) {
  Bytes bytes(true);
  bytes.text("OFF BINARY\n").ints({4, 4, 6});
  for (const Vec3d& p : cornerTetrahedron().points)
    bytes.floats({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  bytes.ints({3, 0, 2, 1, 0});
  bytes.ints({3, 0, 1, 3, 3}).floats({1, 0, 0}); // with a colour
  bytes.ints({3, 0, 3, 2, 0}).ints({3, 1, 2, 3, 0});
  expectOffTetrahedron(reading(readOff, bytes.str()));
  const Reading cut = reading(readOff, bytes.str().substr(0, bytes.str().size() - 5));
  EXPECT_EQ(cut.mesh.triangleCount(), 3U);
  EXPECT_EQ(cut.codes(), "truncated");
}

} // namespace
} // namespace tetvdb
