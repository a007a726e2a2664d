// SPDX-License-Identifier: Apache-2.0
#include "io/VtkTestMesh.h"
#include "tetvdb/io/formats/vtk/VtuReader.h"

#include <cstring>

namespace tetvdb::test {
namespace {

std::string base64(const std::string& bytes) {
  static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
  }
  return out;
}

template <class T>
std::string rawBytes(const std::vector<T>& values) {
  std::string out(values.size() * sizeof(T), '\0');
  std::memcpy(out.data(), values.data(), out.size());
  return out;
}

std::string array(const std::string& name, const std::string& type, const std::string& text,
                  const std::string& more = "format=\"ascii\"") {
  return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" " + more + ">" + text +
         "</DataArray>\n";
}

/// A tet, as text; any part can be another.
struct OneTet {
  std::string header = "type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"";
  std::string counts = "NumberOfPoints=\"4\" NumberOfCells=\"1\"";
  std::string points = array("Points", "Float32", "0 0 0  1 0 0  0 1 0  0 0 1",
                             "NumberOfComponents=\"3\" format=\"ascii\"");
  std::string connectivity = array("connectivity", "Int32", "0 1 2 3");
  std::string offsets = array("offsets", "Int32", "4");
  std::string types = array("types", "UInt8", "10");
  std::string more; ///< further arrays of the cells
  std::string cellData, pointData;

  std::string piece() const {
    return "<Piece " + counts + ">\n<Points>" + points + "</Points>\n<Cells>" + connectivity +
           offsets + types + more + "</Cells>\n<PointData>" + pointData + "</PointData><CellData>" +
           cellData + "</CellData></Piece>\n";
  }
  std::string text() const {
    return "<?xml version=\"1.0\"?>\n<!-- a > b <DataArray> -->\n<VTKFile " + header +
           ">\n<UnstructuredGrid>\n" + piece() + "</UnstructuredGrid>\n</VTKFile>\n";
  }
};

CellMesh readText(const OneTet& tet) {
  return read(readVtu, tet.text());
}
std::string errorOfTet(const OneTet& tet) {
  return test::errorOf(readVtu, tet.text());
}

} // namespace

TEST(VtuReader, EveryEncodingIsTheSameMesh) {
  for (const std::string& name : dataFiles("mixed_", ".vtu")) {
    SCOPED_TRACE(name);
    Report report;
    expectMixedMesh(read(readVtu, fileBytes(dataPath(name)), report, name));
    EXPECT_TRUE(report.warnings.empty());
  }
}

TEST(VtuReader, OneTetAsText) {
  const CellMesh mesh = readText({});
  EXPECT_EQ(mesh.points.size(), 4u);
  EXPECT_EQ(mesh.nodes, (std::vector<std::uint32_t>{0, 1, 2, 3}));
  ASSERT_EQ(mesh.runs.size(), 1u);
  EXPECT_EQ(mesh.runs[0].type, CellType::Tetra);
  EXPECT_EQ(mesh.runs[0].fileType, "tetra");
}

TEST(VtuReader, PolyhedraWithFaces) {
  const CellMesh mesh = read(readVtu, fileBytes(dataPath("polyhedra.vtu")));
  ASSERT_EQ(mesh.runs.size(), 3u);
  EXPECT_EQ(mesh.runs[0].type, CellType::Polyhedron);
  EXPECT_EQ(mesh.runs[0].nodesPerCell, 17u);
  EXPECT_EQ(mesh.runs[1].type, CellType::Tetra);
  EXPECT_EQ(mesh.runs[2].nodesPerCell, 31u);
  ASSERT_EQ(mesh.nodes.size(), 17u + 4 + 31);
  EXPECT_EQ(mesh.nodes[0], 4u);
  EXPECT_EQ(mesh.nodes[17 + 4], 6u);
}

TEST(VtuReader, PolyhedraWithNumberedFaces) { // from VTK 9.4 on
  OneTet tet;
  tet.types = array("types", "UInt8", "42");
  tet.more = array("face_connectivity", "Int64", "0 1 2 0 1 3 1 2 3 0 2 3") +
             array("face_offsets", "Int64", "3 6 9 12") +
             array("polyhedron_to_faces", "Int64", "0 1 2 3") +
             array("polyhedron_offsets", "Int64", "4");
  const CellMesh mesh = readText(tet);
  EXPECT_EQ(mesh.nodes,
            (std::vector<std::uint32_t>{4, 3, 0, 1, 2, 3, 0, 1, 3, 3, 1, 2, 3, 3, 0, 2, 3}));

  tet.more = array("face_connectivity", "Int64", "0 1 2") + array("face_offsets", "Int64", "3") +
             array("polyhedron_to_faces", "Int64", "7") + array("polyhedron_offsets", "Int64", "1");
  EXPECT_FALSE(errorOfTet(tet).empty());
}

TEST(VtuReader, PolyhedronFacesThatDoNotFit) {
  OneTet tet;
  tet.types = array("types", "UInt8", "42");
  EXPECT_TRUE(contains(errorOfTet(tet), "faceoffsets"));
  for (const char* faces :
       {"4 3 0 1 2 3 0 1 3 3 1 2 3 3 0 2 9", "5 3 0 1 2 3 0 1 3 3 1 2 3 3 0 2 3",
        "4 2 0 1 2 3 0 1 3 3 1 2 3 3 0 2 3", "9 9 9 9 9 9 9 9 9 9 9 9 9 9 9 9 9"}) {
    tet.more = array("faces", "Int64", faces) + array("faceoffsets", "Int64", "17");
    EXPECT_FALSE(errorOfTet(tet).empty()) << faces;
  }
}

TEST(VtuReader, PiecesAreOneMesh) {
  OneTet first, second;
  first.pointData = array("T", "Float32", "1 2 3 4") + array("only here", "Float32", "1 2 3 4");
  second.pointData = array("T", "Float64", "5 6 7 8");
  first.cellData = second.cellData = array("material", "Int32", "3");
  OneTet empty;
  empty.counts = "NumberOfPoints=\"0\" NumberOfCells=\"0\"";
  empty.points = empty.connectivity = empty.offsets = empty.types = "";
  std::string text = first.text();
  text.insert(text.find("</UnstructuredGrid>"), empty.piece() + second.piece());

  Report report;
  const CellMesh mesh = read(readVtu, text, report);
  EXPECT_EQ(mesh.points.size(), 8u);
  EXPECT_EQ(mesh.nodes, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7}));
  ASSERT_EQ(mesh.runs.size(), 1u);
  EXPECT_EQ(mesh.runs[0].count, 2u);
  ASSERT_EQ(mesh.attributes.size(), 2u);
  ASSERT_EQ(mesh.attributes[0].size(), 8u);
  EXPECT_EQ(mesh.attributes[0].number(7), 8);
  EXPECT_EQ(mesh.attributes[1].size(), 2u);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_TRUE(contains(report.warnings[0].text, "only here"));
}

TEST(VtuReader, Base64WithHeaderAndDataInOneText) { // as meshio writes it, and broken into lines
  const std::string data = rawBytes<std::int64_t>({0, 1, 2, 3});
  const std::string header = rawBytes<std::uint32_t>({32});
  OneTet tet;
  const std::string together = base64(header + data), apart = base64(header) + base64(data);
  for (std::string text : {together, apart}) {
    tet.connectivity = array("connectivity", "Int64", text, "format=\"binary\"");
    EXPECT_EQ(readText(tet).nodes, (std::vector<std::uint32_t>{0, 1, 2, 3}));
    for (std::size_t i = 7; i < text.size(); i += 10)
      text.insert(i, "\n  ");
    tet.connectivity = array("connectivity", "Int64", text, "format=\"binary\"");
    EXPECT_EQ(readText(tet).nodes, (std::vector<std::uint32_t>{0, 1, 2, 3}));
  }
  for (const std::string& text : {together.substr(0, 30), "!" + together, std::string("===="),
                                  base64(rawBytes<std::uint32_t>({31}) + data)}) {
    tet.connectivity = array("connectivity", "Int64", text, "format=\"binary\"");
    EXPECT_FALSE(errorOfTet(tet).empty()) << text;
  }
}

TEST(VtuReader, NamesAndInformationKeys) {
  OneTet tet;
  tet.pointData = array("a &lt; b &amp; c > d", "Float32",
                        "<InformationKey name=\"x\"><Value> 7 </Value></InformationKey>1 2 3 4");
  const CellMesh mesh = readText(tet);
  ASSERT_EQ(mesh.attributes.size(), 1u);
  EXPECT_EQ(mesh.attributes[0].name, "a < b & c > d");
  EXPECT_EQ(mesh.attributes[0].number(3), 4);
}

TEST(VtuReader, RawDataThatLookLikeTheEnd) {
  const std::string data = rawBytes<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  std::string text = OneTet{}.text();
  OneTet tet;
  tet.points =
      array("Points", "Float32", "", "NumberOfComponents=\"3\" format=\"appended\" offset=\"20\"");
  text = tet.text();
  text.insert(text.find("</VTKFile>"), "<AppendedData encoding=\"raw\"> _</AppendedData>xxxxx" +
                                           rawBytes<std::uint32_t>({48}) + data +
                                           "\n</AppendedData>");
  EXPECT_EQ(read(readVtu, text).points.size(), 4u);
}

TEST(VtuReader, MeshesThatDoNotFit) {
  OneTet tet;
  tet.connectivity = array("connectivity", "Int32", "0 1 2 4");
  EXPECT_TRUE(contains(errorOfTet(tet), "refers to point 4, but there are 4 points"));
  tet.connectivity = array("connectivity", "Int32", "0 1 2 -1");
  EXPECT_TRUE(contains(errorOfTet(tet), "out of range"));
  tet.connectivity = array("connectivity", "Int32", "0 1 2");
  EXPECT_TRUE(contains(errorOfTet(tet), "cut off") || contains(errorOfTet(tet), "number"));

  tet = {};
  tet.offsets = array("offsets", "Int32", "5");
  tet.connectivity = array("connectivity", "Int32", "0 1 2 3 0");
  EXPECT_TRUE(contains(errorOfTet(tet), "has 5 nodes in place of 4"));
  tet.offsets = array("offsets", "Int32", "-4");
  EXPECT_FALSE(errorOfTet(tet).empty());
  tet.offsets = array("offsets", "Float32", "4");
  EXPECT_TRUE(contains(errorOfTet(tet), "whole"));

  tet = {};
  tet.points = array("Points", "Float32", "0 0 0  1 0 0  0 nan 0  0 0 1");
  EXPECT_TRUE(contains(errorOfTet(tet), "point 2 has a coordinate that is not finite"));
  tet.points = "";
  EXPECT_FALSE(errorOfTet(tet).empty());
  tet.points = array("Points", "Float32", "1 2 3 4", "NumberOfComponents=\"1\"");
  EXPECT_TRUE(contains(errorOfTet(tet), "coordinates"));

  tet = {};
  tet.types = "";
  EXPECT_TRUE(contains(errorOfTet(tet), "'types'"));
  for (const char* counts : {"NumberOfPoints=\"4\"", "NumberOfPoints=\"-4\" NumberOfCells=\"1\"",
                             "NumberOfPoints=\"6148914691236517209\" NumberOfCells=\"1\"",
                             "NumberOfPoints=\"4\" NumberOfCells=\"4611686018427387905\"",
                             "NumberOfPoints=\"400000000000\" NumberOfCells=\"1\"",
                             "NumberOfPoints=\"4x\" NumberOfCells=\"1\""}) {
    tet = {};
    tet.counts = counts;
    EXPECT_FALSE(errorOfTet(tet).empty()) << counts;
  }
}

TEST(VtuReader, FilesOfOtherKinds) {
  OneTet tet;
  tet.header = "type=\"ImageData\"";
  EXPECT_TRUE(contains(errorOfTet(tet), "ImageData"));
  tet.header = "type=\"UnstructuredGrid\" compressor=\"vtkOther\"";
  EXPECT_TRUE(contains(errorOfTet(tet), "vtkOther"));
  tet.header = "type=\"UnstructuredGrid\" header_type=\"UInt16\"";
  EXPECT_FALSE(errorOfTet(tet).empty());
  for (const char* text : {"", "hello", "<a/>", "<VTKFile type=\"UnstructuredGrid\"/>", "<VTKFile",
                           "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid></VTKFile>"})
    EXPECT_FALSE(test::errorOf(readVtu, text).empty()) << text;
}

TEST(VtuReader, CompressedBlocksThatLie) {
  OneTet tet;
  tet.header = "type=\"UnstructuredGrid\" compressor=\"vtkZLibDataCompressor\"";
  using Words = std::vector<std::uint32_t>;
  for (const Words& header :
       {Words{1, 0xfffffff0u, 0, 4}, Words{0xffffffffu, 32768, 0, 4},
        Words{1, 32768, 32, 0xfffffff0u}, Words{1, 16, 32, 4}, Words{0, 0, 0}}) {
    tet.connectivity = array("connectivity", "Int64", base64(rawBytes(header)) + base64("abcd"),
                             "format=\"binary\"");
    EXPECT_FALSE(errorOfTet(tet).empty());
  }
}

TEST(VtuReader, WithoutAttributesIntegerCellArraysStay) {
  ReadOptions options;
  options.attributes = false;
  Report report;
  const CellMesh mesh =
      read(readVtu, fileBytes(dataPath("mixed_raw_zlib_64_little.vtu")), report, "test", options);
  EXPECT_EQ(find(mesh, "T", Attribute::On::Points), nullptr);
  EXPECT_NE(find(mesh, "material", Attribute::On::Cells), nullptr);
}

TEST(VtuReader, OnlyWantedArrays) {
  const std::string bytes = fileBytes(dataPath("mixed_raw_zlib_64_little.vtu"));
  Report report;
  const CellMesh all = read(readVtu, bytes, report);
  ReadOptions options;
  options.arrays = {"T"};
  const CellMesh mesh = read(readVtu, bytes, report, "test", options);
  EXPECT_NE(find(mesh, "T", Attribute::On::Points), nullptr);
  EXPECT_EQ(find(mesh, "flow speed", Attribute::On::Points), nullptr);
  EXPECT_NE(find(mesh, "material", Attribute::On::Cells), nullptr); // it may tell regions
  EXPECT_EQ(mesh.attributes.size() + mesh.unread.size(), all.attributes.size());
}

TEST(VtuReader, CanBeCancelled) {
  Progress progress;
  progress.cancel();
  Report report;
  const std::string text = OneTet{}.text();
  EXPECT_THROW(readVtu({text, "test"}, {}, report, progress), Error);
}

TEST(VtuReader, TruncatedIsRefused) {
  for (const std::string& name : dataFiles("mixed_", ".vtu"))
    expectTruncatedIsRefused(readVtu, dataPath(name));
}

// One is missing in the declaration, and one is too many after the points: their numbers stand
// within what looks like a tag.
TEST(VtuReader, QuotationMarksThatAreNotInPairs) {
  OneTet tet;
  tet.points = array("Points", "Float32",
                     "-1 0 0  1 0 0  0 1 0  0 0 1 <InformationKey name=\"L\"> \" "
                     "<Value index=\"0\">1</Value></InformationKey>",
                     "NumberOfComponents=\"3\" format=\"ascii\"");
  std::string text = tet.text();
  text.replace(text.find("\"1.0\""), 5, "1.0\"");
  Progress progress;
  Report report;
  EXPECT_THROW(readVtu({text, "test"}, {}, report, progress), Error);
}

TEST(VtuReader, DamageIsHarmless) {
  for (const std::string& name : dataFiles("mixed_", ".vtu"))
    expectDamageIsHarmless(readVtu, dataPath(name), 300);
  expectDamageIsHarmless(readVtu, dataPath("polyhedra.vtu"), 1000);
}

} // namespace tetvdb::test
