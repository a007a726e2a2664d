// SPDX-License-Identifier: Apache-2.0
#include "io/TriangleSamples.h"
#include "tetvdb/io/formats/obj/ObjReader.h"

namespace tetvdb {
namespace {

using namespace test;

const std::string kFour = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

TEST(ObjReader, EveryFormOfIndices) {
  for (const char* face : {"f 1 2 3", "f 1/4 2/5 3/6", "f 1//7 2//8 3//9", "f 1/1/1 2/2/2 3/3/3",
                           "f 1/ 2/ 3/", "f 1// 2// 3//", "f +1 +2 +3", "f -4 -3 -2",
                           "f -4/-1/-1 2/1/-1 -2//1", "  f\t1  2 3  # a comment", "f 1 2 3 \\"}) {
    const Reading read = reading(readObj, kFour + face);
    ASSERT_EQ(read.error, "") << face;
    EXPECT_EQ(read.mesh.triangles, (Indices{0, 1, 2})) << face;
    EXPECT_EQ(read.codes(), "") << face;
  }
}

TEST(ObjReader, NumbersAsTheyAre) {
  const Reading read =
      reading(readObj, "v 0.1 -2.5e-3 +7\nv 1D2 .5 3.\nv 1e-400 1E+2 0\nf 1 2 3\n");
  EXPECT_EQ(read.mesh.points[0], (Vec3d{0.1, -2.5e-3, 7}));
  EXPECT_EQ(read.mesh.points[1], (Vec3d{100, 0.5, 3}));
  EXPECT_EQ(read.mesh.points[2], (Vec3d{0, 100, 0}));
  EXPECT_EQ(read.codes(), "");
}

TEST(ObjReader, PolygonsAreFans) {
  const Reading read = reading(readObj, kFour + "v 5 5 5\nf 5 1 2 3 4\nf 1 2 3\n");
  EXPECT_EQ(read.mesh.triangles, (Indices{4, 0, 1, 4, 1, 2, 4, 2, 3, 0, 1, 2}));
  EXPECT_EQ(read.mesh.faceCount, 2U);
}

TEST(ObjReader, NegativeIndicesCountFromWhereTheyStand) {
  const Reading read =
      reading(readObj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -3 -2 -1\n");
  EXPECT_EQ(read.mesh.triangles, (Indices{0, 1, 2, 1, 2, 3}));
}

TEST(ObjReader, FacesMayComeBeforeTheirVertices) {
  const Reading read =
      reading(readObj, "f 1 2 3\n" + kFour + "f 1 2 4\nf 9 1 2\nf 5 2 3\nv 1 1 1\n");
  EXPECT_EQ(read.mesh.triangles, (Indices{0, 1, 2, 0, 1, 3, 4, 1, 2}));
  EXPECT_EQ(read.codes(), "bad-faces");
}

TEST(ObjReader, WhatElseVerticesHoldAndOtherStatements) {
  const std::string text = "mtllib a.mtl\no thing\nvt 0 0\nvn 0 0 1\ng a b\nusemtl red\ns off\n"
                           "v 0 0 0 1\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0 1 0.2 0.3 0.4 # c\n"
                           "vp 0 1\nl 1 2 3\np 1\ncurv 0 1 1 2\nfo 1 2 3\nf 1 2 3\n";
  const Reading read = reading(readObj, text);
  EXPECT_EQ(read.mesh.points.size(), 3U);
  EXPECT_EQ(read.mesh.triangles, (Indices{0, 1, 2}));
  EXPECT_EQ(read.codes(), "");
}

TEST(ObjReader, LineEndsContinuationsAndMarks) {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    const std::string n = end;
    const Reading read =
        reading(readObj, "\xef\xbb\xbf# C:\\path\\" + n + "v 0 0 0" + n + "v 1 \\" + n + " 0 0" +
                             n + "usemtl a\\" + n + "v 0 1 0" + n + n + "f 1 \\ " + n + "2 \\" + n +
                             "\\" + n + "3" + n);
    ASSERT_EQ(read.error, "");
    EXPECT_EQ(read.mesh.points, (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(read.mesh.triangles, (Indices{0, 1, 2}));
    EXPECT_EQ(read.codes(), "");
  }
}

TEST(ObjReader, UnreadableVerticesKeepTheirPlace) {
  for (const char* bad : {"v nan 0 0", "v 0 inf 0", "v 1e400 0 0", "v 1 2", "v", "v x y z",
                          "v 1.#IND 0 0", "v 1,5 2,5 3,5", "v 1 2 # 3"}) {
    const Reading read =
        reading(readObj, "v 0 0 0\n" + std::string(bad) + "\nv 1 0 0\nv 0 1 0\nf 1 3 4\nf 1 2 3\n");
    ASSERT_EQ(read.error, "") << bad;
    ASSERT_EQ(read.mesh.points.size(), 4U) << bad;
    EXPECT_EQ(read.mesh.points[1], (Vec3d{0, 0, 0}));
    EXPECT_EQ(read.mesh.triangles, (Indices{0, 2, 3})) << bad;
    EXPECT_EQ(read.codes(), "bad-vertices bad-faces") << bad;
    EXPECT_TRUE(read.report.partial);
  }
}

TEST(ObjReader, FacesWithoutMeaningAreLeftOutAndCounted) {
  for (const char* bad : {"f 0 1 2", "f 1 2 5", "f -5 1 2", "f 1 2", "f", "f 1 2 x", "f /1 /1 /1",
                          "f 1 2 99999999999999999999", "f 1 2 4294967296", "f 1 2 3.5",
                          "f 1 2 \\x", "f 1 2 3 4 17", "f 1 2 -9223372036854775808"}) {
    const Reading read = reading(readObj, kFour + bad + "\nf 1 2 3\n" + bad + "\n");
    ASSERT_EQ(read.error, "") << bad;
    EXPECT_EQ(read.mesh.triangles, (Indices{0, 1, 2})) << bad;
    EXPECT_EQ(read.mesh.faceCount, 1U);
    EXPECT_EQ(read.codes(), "bad-faces") << bad;
    EXPECT_TRUE(read.report.partial);
    EXPECT_NE(read.report.warnings[0].text.find("2 faces"), std::string::npos);
  }
}

TEST(ObjReader, RepeatedCornersAreKept) {
  const Reading read = reading(readObj, kFour + "f 1 1 2\nf 1 2 3\nf 1 2 3\n");
  EXPECT_EQ(read.mesh.triangleCount(), 3U);
  EXPECT_EQ(read.codes(), "");
}

TEST(ObjReader, NoFacesIsAnError) {
  EXPECT_NE(reading(readObj, kFour).error.find("4 points but no faces"), std::string::npos);
  EXPECT_NE(reading(readObj, "l 1 2\n").error.find("no faces"), std::string::npos);
  EXPECT_NE(reading(readObj, kFour + "f 7 8 9\n").error.find("none of its 1 faces"),
            std::string::npos);
}

} // namespace
} // namespace tetvdb
