// SPDX-License-Identifier: Apache-2.0
#include "io/TriangleSamples.h"

namespace tetvdb {
namespace {

using namespace test;

FileFormat sniff(const std::string& bytes, const std::string& path = "a") {
  return sniffFormat(bytes, path);
}

std::string binaryStl(std::string header) {
  header.resize(80, ' ');
  return Bytes().text(header).add<std::uint32_t>({1}).str() + std::string(50, '\0');
}

TEST(TriangleReader, FormatsAreToldByContent) {
  EXPECT_EQ(sniff(binaryStl("made by hand"), "a.obj"), FileFormat::Stl);
  EXPECT_EQ(sniff(binaryStl("solid"), "a.ply"), FileFormat::Stl);
  EXPECT_EQ(sniff(binaryStl(std::string("\1\0\0\0\2\0\0\0", 8))), FileFormat::Stl);
  EXPECT_EQ(sniff("solid a\nfacet normal 0 0 1\n", "a.off"), FileFormat::Stl);
  EXPECT_EQ(sniff("\n  SOLID\nendsolid\n"), FileFormat::Stl);
  EXPECT_EQ(sniff("ply\nformat ascii 1.0\n", "a.stl"), FileFormat::Ply);
  EXPECT_EQ(sniff("ply\r\nformat ascii 1.0\r\n"), FileFormat::Ply);
  for (const char* text : {"OFF\n", "OFF3514 3546 0\n", "COFF 1 1\n", "# c\n\nNOFF\n", "STOFF\n",
                           "STCNOFF\n", "4OFF\n", "OFF BINARY\n", "off\n", "\xef\xbb\xbfOFF\n"})
    EXPECT_EQ(sniff(text, "a.obj"), FileFormat::Off) << text;
  EXPECT_EQ(sniff("offset 3\n"), FileFormat::Unknown);
  EXPECT_EQ(sniff("# made by\n\nv 0 0 0\nv 1 2 3\nf 1 2 3\n", "a.txt"), FileFormat::Obj);
  EXPECT_EQ(sniff("mtllib a\no a\nv 0 0 0 \\\n 1\nf 1 2 3\n"), FileFormat::Obj);
  EXPECT_EQ(sniff("v of a poem\n"), FileFormat::Unknown);
  EXPECT_EQ(sniff("nonsense", "a.obj"), FileFormat::Obj);
  EXPECT_EQ(sniff("PK\x03\x04.....3D/3dmodel.model", "a.zip"), FileFormat::ThreeMf);
  EXPECT_EQ(sniff("PK\x03\x04.....word/document.xml", "a.docx"), FileFormat::Unknown);
  EXPECT_EQ(sniff("glTF\2", "a.bin"), FileFormat::Gltf);
  EXPECT_EQ(sniff("{ \"asset\" : {} }", "a.json"), FileFormat::Gltf);
  EXPECT_EQ(sniff("Kaydara FBX Binary  ", "a"), FileFormat::Fbx);
  EXPECT_EQ(sniff("; FBX 7.4.0 project file\n", "a"), FileFormat::Fbx);
  EXPECT_EQ(sniff("<?xml version=\"1.0\"?>\n<COLLADA>", "a.xml"), FileFormat::Collada);
  EXPECT_EQ(sniff(std::string("MM\x20\0\0\0\x02\0", 8), "a"), FileFormat::ThreeDs);
  EXPECT_EQ(sniff(std::string("MM\0\x2a\0\0\0\x08", 8), "a.tif"), FileFormat::Tiff);
}

TEST(TriangleReader, TheNameDecidesWhatTheContentLeavesOpen) {
  EXPECT_EQ(sniff(binaryStl("").substr(0, 100), "a.stl"), FileFormat::Stl);
  EXPECT_EQ(sniff("4 4 6\n0 0 0\n", "a.off"), FileFormat::Off);
  EXPECT_EQ(sniff("4 4 6\n0 0 0\n", "a.txt"), FileFormat::Unknown);
  EXPECT_EQ(sniff("broken", "a.3mf"), FileFormat::ThreeMf);
}

TEST(TriangleReader, HoldsTriangles) {
  for (const FileFormat format :
       {FileFormat::Stl, FileFormat::Obj, FileFormat::Off, FileFormat::Ply, FileFormat::ThreeMf,
        FileFormat::Gltf, FileFormat::Fbx, FileFormat::Collada, FileFormat::ThreeDs})
    EXPECT_TRUE(holdsTriangles(format));
  for (const FileFormat format : {FileFormat::Unknown, FileFormat::Gmsh, FileFormat::Exodus})
    EXPECT_FALSE(holdsTriangles(format));
}

TEST(TriangleReader, ReadsByContent) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  FileFormat format = FileFormat::Unknown;
  EXPECT_EQ(readingFile("a.stl", obj, &format).mesh.triangleCount(), 1U);
  EXPECT_EQ(format, FileFormat::Obj);
  EXPECT_EQ(readingFile("a.ply", "OFF 3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2", &format).error, "");
  EXPECT_EQ(format, FileFormat::Off);
  EXPECT_EQ(readingFile("A.OBJ", "f 1 2 3\n" + obj).mesh.triangleCount(), 2U);
}

TEST(TriangleReader, OtherFilesAreDescribed) {
  const auto error = [](const std::string& name, const std::string& bytes) {
    const Reading read = readingFile(name, bytes);
    EXPECT_EQ(read.status, Status::Invalid);
    return read.error;
  };
  EXPECT_NE(error("a.msh", kGmsh2).find("holds solid cells"), std::string::npos);
  EXPECT_NE(error("a.vdb", " BDV").find("OpenVDB volume"), std::string::npos);
  EXPECT_NE(error("a.step", "ISO-10303-21;\n").find("STEP"), std::string::npos);
  EXPECT_NE(error("a.txt", "hello").find("not a mesh"), std::string::npos);
  EXPECT_NE(error("a.zip", "PK\x03\x04").find("ZIP"), std::string::npos);
  EXPECT_NE(error("a.stl", "").find("empty"), std::string::npos);
  EXPECT_NE(error("a.3mf", "hello").find("ZIP"), std::string::npos);
}

TEST(TriangleReader, StopsWhenCancelled) {
  std::string obj;
  for (int i = 0; i < 1000; ++i)
    obj += "v 0 0 0\n";
  const TemporaryPath path("cancelled.obj", obj + "f 1 2 3\n");
  Report report;
  Progress progress;
  progress.cancel();
  try {
    readTriangles(path.str(), report, progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Cancelled);
  }
}

} // namespace
} // namespace tetvdb
