// SPDX-License-Identifier: Apache-2.0
#include "io/TriangleSamples.h"
#include "tetvdb/io/formats/ply/PlyReader.h"

#include <limits>

namespace tetvdb {
namespace {

using namespace test;

std::string header(const std::string& format, const std::string& rest,
                   const std::string& end = "\n") {
  std::string text = "ply\nformat " + format + " 1.0\ncomment made by hand\nobj_info 4 points\n" +
                     rest + "end_header\n";
  for (std::size_t at = 0; end != "\n" && (at = text.find('\n', at)) != text.npos; at += end.size())
    text.replace(at, 1, end);
  return text;
}
const std::string kVertex =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kFace = "element face 4\nproperty list uchar int vertex_indices\n";
const std::string kRows = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

void expectTetrahedron(const Reading& read, const std::string& codes = "") {
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.points, cornerTetrahedron().points);
  EXPECT_EQ(read.mesh.triangles, cornerTetrahedron().triangles);
  EXPECT_EQ(read.codes(), codes);
}

TEST(PlyReader, Text) {
  for (const char* end : {"\n", "\r\n", "\r"})
    expectTetrahedron(reading(readPly, header("ascii", kVertex + kFace, end) + kRows));
  std::string flat = kRows;
  for (char& c : flat)
    c = c == '\n' ? ' ' : c;
  expectTetrahedron(reading(readPly, header("ascii", kVertex + kFace) + flat));
}

TEST(PlyReader, TextWithFurtherPropertiesAndElements) {
  const std::string head =
      "element camera 1\nproperty float a\nproperty list int float b\n"
      "element vertex 4\nproperty uchar red\nproperty double z\nproperty float y\n"
      "property float32 x\nproperty list uchar int neighbours\n"
      "element nothing 3\nelement face 4\nproperty list uchar float texcoord\n"
      "property list uint8 uint32 vertex_index\nproperty uchar red\n"
      "element edge 1\nproperty int a\n";
  const std::string rows =
      "1 2 3 4\n"
      "9 0 0 0 0\n9 0 0 1 2 8 8\n9 0 1 0 0\n9 1 0 0 1 5\n"
      "0 3 0 2 1 255\n1 .5 3 0 1 3 255\n0 3 0 3 2 255 and more\n0 3 1 2 3 255\n7\n";
  expectTetrahedron(reading(readPly, header("ascii", head) + rows));
}

template <class Index, class Count>
std::string binary(bool big, const std::string& types) {
  Bytes bytes(big);
  bytes.text(header(big ? "binary_big_endian" : "binary_little_endian",
                    "element vertex 4\nproperty double x\nproperty short flag\nproperty float y\n"
                    "property char z\nelement extra 2\nproperty list int double values\n"
                    "element face 4\nproperty uchar red\nproperty list " +
                        types + " vertex_indices\nproperty list uchar short more\n"));
  for (const Vec3d& p : cornerTetrahedron().points)
    bytes.doubles({p[0]})
        .add<std::int16_t>({-3})
        .floats({static_cast<float>(p[1])})
        .add<std::int8_t>({static_cast<std::int8_t>(p[2])});
  bytes.ints({2}).doubles({1, 2}).ints({0});
  const Indices corners = cornerTetrahedron().triangles;
  for (std::size_t t = 0; t < 4; ++t) {
    bytes.add<std::uint8_t>({255}).add<Count>({Count(3)});
    for (std::size_t k = 0; k < 3; ++k)
      bytes.add<Index>({static_cast<Index>(corners[3 * t + k])});
    bytes.add<std::uint8_t>({1}).add<std::int16_t>({-1});
  }
  return bytes.str();
}

TEST(PlyReader, BinaryOfEveryTypeAndOrder) {
  for (const bool big : {false, true}) {
    expectTetrahedron(reading(readPly, binary<std::int32_t, std::uint8_t>(big, "uchar int")));
    expectTetrahedron(reading(readPly, binary<std::uint32_t, std::int8_t>(big, "int8 uint32")));
    expectTetrahedron(reading(readPly, binary<std::uint16_t, std::int32_t>(big, "int ushort")));
    expectTetrahedron(reading(readPly, binary<std::int16_t, std::uint32_t>(big, "uint int16")));
    expectTetrahedron(reading(readPly, binary<std::uint8_t, std::uint16_t>(big, "uint16 uchar")));
    expectTetrahedron(reading(readPly, binary<std::int8_t, std::int16_t>(big, "short char")));
    expectTetrahedron(reading(readPly, binary<float, double>(big, "double float")));
    expectTetrahedron(reading(readPly, binary<double, float>(big, "float32 float64")));
  }
}

TEST(PlyReader, OneLineOfTheHeaderMayEndInAnotherWay) {
  for (const char* line : {"ply\n", "comment", "end_header"}) {
    std::string bytes = binary<std::int32_t, std::uint8_t>(false, "uchar int");
    bytes.replace(bytes.find('\n', bytes.find(line)), 1, "\r\n");
    expectTetrahedron(reading(readPly, bytes));
  }
}

TEST(PlyReader, DataMayBeginWithALineBreak) {
  // The first byte of the data is that of '\n': the header's lines do not end with it.
  const std::string head = header("binary_little_endian",
                                  "element vertex 3\nproperty char x\nproperty char y\n"
                                  "property char z\nelement face 1\nproperty list uchar uchar "
                                  "vertex_indices\n",
                                  "\r");
  const Reading read =
      reading(readPly, head + std::string("\n\x00\x00\x01\x00\x00\x00\x01\x00", 9) +
                           std::string("\x03\x00\x01\x02", 4));
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.points[0], (Vec3d{10, 0, 0}));
}

TEST(PlyReader, FacesBeforeVertices) {
  expectTetrahedron(reading(readPly, header("ascii", kFace + kVertex) +
                                         "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
                                         "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"));
}

TEST(PlyReader, PolygonsAndStrips) {
  const Reading fan =
      reading(readPly, header("ascii", kVertex + "element face 1\nproperty list uchar "
                                                 "int vertex_indices\n") +
                           "0 0 0\n1 0 0\n0 1 0\n0 0 1\n4 3 2 1 0\n");
  EXPECT_EQ(fan.mesh.triangles, (Indices{3, 2, 1, 3, 1, 0}));
  const Reading strips =
      reading(readPly, header("ascii", kVertex + "element tristrips 1\nproperty list int int "
                                                 "vertex_indices\n") +
                           "0 0 0\n1 0 0\n0 1 0\n0 0 1\n10 0 1 2 3 0 -1 3 2 1 -1\n");
  EXPECT_EQ(strips.mesh.triangles, (Indices{0, 1, 2, 2, 1, 3, 2, 3, 0, 3, 2, 1}));
}

TEST(PlyReader, FacesWithoutMeaningAreLeftOut) {
  for (const char* bad : {"3 0 1 4", "3 0 1 -1", "2 0 1", "3 0 1 nan", "0", "x 1 2 3", "-2 1 2"}) {
    const Reading read = reading(readPly, header("ascii", kVertex + kFace) +
                                              "0 0 0\n1 0 0\n0 1 0\n"
                                              "0 0 1\n3 0 1 2\n3 0 2 3\n" +
                                              bad + "\n3 1 2 3\n");
    ASSERT_EQ(read.error, "");
    EXPECT_EQ(read.mesh.triangles, (Indices{0, 1, 2, 0, 2, 3, 1, 2, 3})) << bad;
    EXPECT_EQ(read.codes(), "bad-faces") << bad;
    EXPECT_TRUE(read.report.partial);
  }
}

TEST(PlyReader, UnreadableVerticesKeepTheirPlace) {
  std::string rows = kRows;
  rows.replace(0, 5, "0 nan 0");
  const Reading read = reading(readPly, header("ascii", kVertex + kFace) + rows);
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.points.size(), 4U);
  EXPECT_EQ(read.mesh.triangles, (Indices{1, 2, 3}));
  EXPECT_EQ(read.codes(), "bad-vertices bad-faces");
}

TEST(PlyReader, CutOffKeepsWholeFaces) {
  const std::string text = header("ascii", kVertex + kFace) + kRows;
  const std::size_t faces = text.size() - 32;
  for (std::size_t size = faces + 8; size < text.size() - 2; ++size) {
    const Reading read = reading(readPly, text.substr(0, size));
    ASSERT_EQ(read.error, "");
    EXPECT_EQ(read.mesh.triangleCount(), (size - faces + 1) / 8) << size;
    EXPECT_EQ(read.codes(), "truncated");
    EXPECT_TRUE(read.report.partial);
  }
  const std::string bytes = binary<std::int32_t, std::uint8_t>(false, "uchar int");
  constexpr std::size_t row = 1 + 1 + 12 + 1 + 2;
  for (std::size_t cut = 1; cut < 3 * row; ++cut) {
    const Reading read = reading(readPly, bytes.substr(0, bytes.size() - cut));
    EXPECT_EQ(read.mesh.triangleCount(), 4 - (cut + row - 1) / row) << cut;
    EXPECT_EQ(read.codes(), "truncated");
  }
  EXPECT_NE(reading(readPly, text.substr(0, faces - 3)).error.find("before any face"),
            std::string::npos);
}

TEST(PlyReader, CountsThatTheFileCannotHold) {
  const auto declared = [](const std::string& vertices, const std::string& faces) {
    return "element vertex " + vertices + "\nproperty char x\nproperty char y\nproperty char z\n" +
           "element face " + faces + "\nproperty list uint uint vertex_indices\n";
  };
  for (const char* format : {"ascii", "binary_little_endian"}) {
    EXPECT_NE(reading(readPly, header(format, declared("999999999999", "1")) + "0 0 0\n").error,
              "");
    EXPECT_NE(reading(readPly, header(format, declared("1", "999999999999")) + "\0\0\0").error, "");
    EXPECT_NE(reading(readPly, header(format, declared("-1", "1")) + "0 0 0\n").error, "");
  }
  const std::string lists = header("binary_little_endian", declared("1", "1"));
  EXPECT_NE(reading(readPly, lists + std::string(3, '\0') + std::string(8, '\xff')).error, "");
}

TEST(PlyReader, LinesThatAreNoStatements) {
  expectTetrahedron(
      reading(readPly, header("ascii", "Created by Blender3D 247\n" + kVertex + kFace) + kRows),
      "header-line");
}

TEST(PlyReader, BrokenHeaders) {
  for (const std::string& head :
       {std::string("plx\n"), std::string("ply\n"), "ply\n" + kVertex + kFace + "end_header\n",
        header("ascii", "element vertex x\n"), header("ascii", "property float x\n"),
        header("ascii", "element vertex 3\nproperty flaot x\n"),
        header("ascii", "element vertex 3\nproperty float\n"), header("ascii", "hello\n"),
        header("ascii", kVertex + "proprety int a\n" + kFace),
        header("binary_middle_endian", kVertex + kFace)}) {
    const Reading read = reading(readPly, head + kRows);
    EXPECT_EQ(read.error.find("file:"), 0U) << read.error;
    EXPECT_EQ(read.status, Status::Invalid);
  }
  EXPECT_NE(reading(readPly, header("ascii", kVertex) + kRows).error.find("no faces"),
            std::string::npos);
  EXPECT_NE(reading(readPly, header("ascii", kFace) + kRows).error.find("no vertices"),
            std::string::npos);
}

} // namespace
} // namespace tetvdb
