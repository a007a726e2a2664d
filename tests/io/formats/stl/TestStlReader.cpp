// SPDX-License-Identifier: Apache-2.0
#include "io/TriangleSamples.h"
#include "tetvdb/io/formats/stl/StlReader.h"

#include <algorithm>
#include <limits>

namespace tetvdb {
namespace {

using namespace test;

/// `n` facets; corner k of facet i is (i, k, 0.5).
std::string binary(std::uint32_t n, std::uint32_t declared, std::string header = "made by hand") {
  header.resize(80, ' ');
  Bytes bytes;
  bytes.text(header).add<std::uint32_t>({declared});
  for (std::uint32_t i = 0; i < n; ++i) {
    bytes.floats({0, 0, 1});
    for (int k = 0; k < 3; ++k)
      bytes.floats({static_cast<float>(i), static_cast<float>(k), 0.5F});
    bytes.add<std::uint16_t>({7});
  }
  return bytes.str();
}

void expectFacets(const Reading& read, std::size_t n) {
  ASSERT_EQ(read.error, "");
  ASSERT_EQ(read.mesh.points.size(), 3 * n);
  EXPECT_EQ(read.mesh.faceCount, n);
  for (std::size_t i = 0; i < 3 * n; ++i) {
    const Vec3d wanted{static_cast<double>(i / 3), static_cast<double>(i % 3), 0.5};
    EXPECT_EQ(read.mesh.points[i], wanted);
    EXPECT_EQ(read.mesh.triangles[i], i);
  }
}

std::string facet(const std::string& corners) {
  return "facet normal 0 0 1\n outer loop\n" + corners + " endloop\nendfacet\n";
}
const std::string kFacet0 = facet("vertex 0 0 .5\nvertex 0 1 0.5\nvertex 0 2 5e-1\n");
const std::string kFacet1 = facet("vertex 1 0 .5\nvertex +1 1 0.5\nvertex 1.0 2 .5\n");

std::string allReplaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

TEST(StlReader, Binary) {
  const Reading read = reading(readStl, binary(5, 5));
  expectFacets(read, 5);
  EXPECT_EQ(read.codes(), "");
  EXPECT_FALSE(read.report.partial);
}

TEST(StlReader, BinaryThatBeginsWithSolid) {
  expectFacets(reading(readStl, binary(3, 3, "solid facet normal vertex endsolid")), 3);
  // The count is wrong as well: the content decides.
  expectFacets(reading(readStl, binary(3, 4, "solid cube")), 3);
}

TEST(StlReader, BinaryCutOffKeepsWholeFacets) {
  const std::string whole = binary(5, 5);
  for (const std::size_t cut :
       {std::size_t(1), std::size_t(49), std::size_t(50), std::size_t(75)}) {
    const Reading read = reading(readStl, whole.substr(0, whole.size() - cut));
    expectFacets(read, cut > 50 ? 3 : 4);
    EXPECT_EQ(read.codes(), "truncated");
    EXPECT_TRUE(read.report.partial);
  }
}

TEST(StlReader, BinaryWithoutAnyFacet) {
  EXPECT_NE(reading(readStl, binary(0, 0)).error.find("no facets"), std::string::npos);
  EXPECT_NE(reading(readStl, binary(1, 1).substr(0, 100)).error, "");
  EXPECT_NE(reading(readStl, binary(1, 1).substr(0, 60)).error, "");
}

TEST(StlReader, BinaryWithTrailingBytes) {
  for (const std::string& rest : {std::string(17, 'x'), std::string(50, '\0')}) {
    const Reading read = reading(readStl, binary(4, 4) + rest);
    expectFacets(read, 4);
    EXPECT_EQ(read.codes(), "trailing-bytes");
    EXPECT_FALSE(read.report.partial);
  }
}

TEST(StlReader, BinaryWithACountTooSmall) {
  for (const std::uint32_t declared : {0U, 2U}) {
    const Reading read = reading(readStl, binary(6, declared));
    expectFacets(read, 6);
    EXPECT_EQ(read.codes(), "wrong-count");
  }
}

TEST(StlReader, FacetsThatAreNotFiniteAreLeftOut) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
    std::string bytes = binary(3, 3);
    std::copy_n(reinterpret_cast<const char*>(&bad), 4, bytes.begin() + 84 + 2 * 50 + 12 + 16);
    const Reading read = reading(readStl, bytes);
    expectFacets(read, 2);
    EXPECT_EQ(read.codes(), "bad-faces");
    EXPECT_TRUE(read.report.partial);
    // A normal has no meaning here.
    std::string normal = binary(3, 3);
    std::copy_n(reinterpret_cast<const char*>(&bad), 4, normal.begin() + 84);
    EXPECT_EQ(reading(readStl, normal).codes(), "");
  }
  std::string none = binary(1, 1);
  std::fill(none.begin() + 96, none.begin() + 132, '\xff');
  EXPECT_NE(reading(readStl, none).error.find("finite"), std::string::npos);
}

TEST(StlReader, Text) {
  const std::string text = "solid a\n" + kFacet0 + kFacet1 + "endsolid a\n";
  for (const std::string& variant :
       {text, allReplaced(text, "\n", "\r\n"), allReplaced(text, "\n", "\r"),
        allReplaced(text, "\n", " "), allReplaced(text, "solid a", "SOLID"),
        allReplaced(text, "vertex", "  VERTEX\t"), allReplaced(text, " normal 0 0 1", ""),
        allReplaced(text, " normal 0 0 1", " normal nan nan nan"), "\xef\xbb\xbf" + text,
        "; a comment\n" + text, allReplaced(text, "endsolid a", "end solid"),
        allReplaced(text, "solid a", "solid a vertex 1 2 3 facet endsolid")}) {
    const Reading read = reading(readStl, variant);
    expectFacets(read, 2);
    EXPECT_EQ(read.codes(), "") << variant;
  }
}

TEST(StlReader, SeveralSolids) {
  const Reading read = reading(readStl, "solid a\n" + kFacet0 + "endsolid a\nsolid b\n" + kFacet1 +
                                            "endsolid b\nsolid empty\nendsolid empty\n");
  expectFacets(read, 2);
  EXPECT_EQ(read.codes(), "");
}

TEST(StlReader, TextCutOffKeepsWholeFacets) {
  const std::string text = "solid a\n" + kFacet0 + kFacet1 + "endsolid a\n";
  const std::size_t second = text.find(kFacet1);
  for (std::size_t size = second; size < text.size() - 11; ++size) {
    const Reading read = reading(readStl, text.substr(0, size));
    ASSERT_EQ(read.codes(), "truncated") << size;
    EXPECT_TRUE(read.report.partial);
    // The last number may be half of one until something follows it.
    expectFacets(read, size > text.rfind(".5\n") + 2 ? 2 : 1);
  }
}

TEST(StlReader, TextFacetsWithoutThreeNumbers) {
  for (const char* bad : {"vertex 9 blah 0\n", "vertex 9 9\n", "vertex nan 0 0\n",
                          "vertex 1.#IND 0 0\n", "vertex 1e999 0 0\n", "vertex 0x1 2 3\n"}) {
    const Reading read =
        reading(readStl, "solid a\n" + kFacet0 +
                             facet("vertex 9 8 7\n" + std::string(bad) + "vertex 1 2 3\n") +
                             kFacet1 + "endsolid\n");
    expectFacets(read, 2);
    EXPECT_EQ(read.codes(), "bad-faces") << bad;
    EXPECT_TRUE(read.report.partial);
  }
  const Reading two =
      reading(readStl, "solid a\n" + kFacet0 + facet("vertex 9 8 7\nvertex 1 2 3\n") + kFacet1 +
                           "endsolid\n");
  expectFacets(two, 2);
  EXPECT_EQ(two.codes(), "bad-faces");
}

TEST(StlReader, TextFacetsOfFourCornersAreFans) {
  const Reading read = reading(
      readStl,
      "solid\n" + facet("vertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n") + "endsolid\n");
  ASSERT_EQ(read.mesh.triangleCount(), 2U);
  EXPECT_EQ(read.mesh.faceCount, 1U);
  EXPECT_EQ(read.mesh.points[4], (Vec3d{1, 1, 0}));
}

TEST(StlReader, NothingOfThemIsAnError) {
  EXPECT_NE(reading(readStl, "solid nothing\nendsolid nothing\n").error.find("no facets"),
            std::string::npos);
  EXPECT_NE(reading(readStl, "hello").error, "");
}

} // namespace
} // namespace tetvdb
