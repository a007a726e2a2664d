// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "io/TriangleSamples.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/io/formats/threemf/ThreeMfReader.h"
#include "tetvdb/io/text/ZipDirectory.h"
#include "tetvdb/io/text/ZipWriter.h"

namespace tetvdb {
namespace {

using namespace test;

const std::string kMesh = R"(<mesh><vertices>
<vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/>
</vertices><triangles>
<triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/><triangle v1="0" v2="3" v3="2"/><triangle v1="1" v2="2" v3="3"/>
</triangles></mesh>)";

std::string object(int id, const std::string& content) {
  return "<object id=\"" + std::to_string(id) + "\" type=\"model\">" + content + "</object>";
}
std::string components(const std::string& list) {
  return "<components>" + list + "</components>";
}
std::string component(int id, const std::string& transform = "") {
  return "<component objectid=\"" + std::to_string(id) + "\"" +
         (transform.empty() ? "" : " transform=\"" + transform + "\"") + "/>";
}
std::string item(int id, const std::string& transform = "") {
  return "<item objectid=\"" + std::to_string(id) + "\"" +
         (transform.empty() ? "" : " transform=\"" + transform + "\"") + "/>";
}
std::string model(const std::string& objects, const std::string& items,
                  const std::string& unit = "millimeter") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?><model unit=\"" + unit +
         "\" xml:lang=\"en-US\" "
         "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources>" +
         objects + "</resources><build>" + items + "</build></model>";
}

std::string archive(const std::string& modelText, const std::string& otherText = "") {
  const TemporaryPath path("archive.3mf");
  AtomicFile file(path.str());
  ZipWriter zip(file);
  const std::pair<const char*, std::string> files[] = {
      {"[Content_Types].xml",
       "<?xml version=\"1.0\"?><Types "
       "xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\"><Default "
       "Extension=\"rels\" "
       "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/><Default "
       "Extension=\"model\" "
       "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>"},
      {"_rels/.rels",
       "<?xml version=\"1.0\"?><Relationships "
       "xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship "
       "Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
       "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>"},
      {"3D/3dmodel.model", modelText},
      {"3D/Objects/other.model", otherText}};
  for (const auto& [name, text] : files) {
    if (text.empty())
      continue;
    zip.begin(name);
    zip.write(text);
    zip.end();
  }
  zip.finish();
  file.commit();
  return readFile(path.str());
}

TEST(ThreeMfReader, ItemsAreAllRead) {
  const Reading read =
      reading(readThreeMf, archive(model(object(1, kMesh), item(1) + item(1, "2 0 0 0 1 0 0 0 1 "
                                                                             "10 20 30"))));
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.points.size(), 8U);
  EXPECT_EQ(read.mesh.triangleCount(), 8U);
  EXPECT_EQ(read.mesh.faceCount, 8U);
  EXPECT_EQ(read.mesh.points[5], (Vec3d{12, 20, 30}));
  EXPECT_NEAR(meshes::signedVolume(read.mesh), 0.5, 1e-12);
  EXPECT_EQ(read.mesh.units, "millimetre");
  EXPECT_EQ(read.codes(), "");
}

TEST(ThreeMfReader, ComponentsComposeInsideOut) {
  // x doubles within the part; the whole turns x into y and moves.
  const std::string turn = "0 1 0 -1 0 0 0 0 1 100 0 0";
  const Reading read =
      reading(readThreeMf,
              archive(model(object(1, kMesh) +
                                object(2, components(component(1, "2 0 0 0 1 0 0 0 1 5 0 0"))) +
                                object(3, components(component(2) + component(2, turn))),
                            item(3, "1 0 0 0 1 0 0 0 1 0 0 7"))));
  ASSERT_EQ(read.error, "");
  ASSERT_EQ(read.mesh.points.size(), 8U);
  EXPECT_EQ(read.mesh.points[1], (Vec3d{7, 0, 7}));
  EXPECT_EQ(read.mesh.points[5], (Vec3d{100, 7, 7}));
  EXPECT_EQ(read.mesh.points[6], (Vec3d{99, 5, 7}));
  EXPECT_NEAR(meshes::signedVolume(read.mesh), 4.0 / 6, 1e-12);
}

TEST(ThreeMfReader, PartsInOtherModelFiles) {
  std::string list = component(5, "1 0 0 0 1 0 0 0 1 9 0 0") + component(1);
  list.insert(list.find("objectid"), "p:path=\"/3D/objects/Other.model\" ");
  const std::string main = model(object(1, kMesh) + object(2, components(list)), item(2));
  const Reading read = reading(readThreeMf, archive(main, model(object(5, kMesh), "", "inch")));
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.triangleCount(), 8U);
  EXPECT_EQ(read.mesh.points[1], (Vec3d{10, 0, 0}));
  EXPECT_EQ(read.mesh.units, "millimetre");
  const Reading missing = reading(readThreeMf, archive(main));
  EXPECT_EQ(missing.mesh.triangleCount(), 4U);
  EXPECT_EQ(missing.codes(), "missing-objects");
}

TEST(ThreeMfReader, MirroredObjectsStayOutward) {
  const Reading read =
      reading(readThreeMf, archive(model(object(1, kMesh), item(1, "-3 0 0 0 1 0 0 0 1 0 0 0"))));
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.points[1], (Vec3d{-3, 0, 0}));
  EXPECT_NEAR(meshes::signedVolume(read.mesh), 0.5, 1e-12);
  // Mirrored twice is not mirrored.
  const Reading twice =
      reading(readThreeMf,
              archive(model(object(1, kMesh) +
                                object(2, components(component(1, "1 0 0 0 -1 0 0 0 1 0 0 0"))),
                            item(2, "-1 0 0 0 1 0 0 0 1 0 0 0"))));
  EXPECT_NEAR(meshes::signedVolume(twice.mesh), 1.0 / 6, 1e-12);
  EXPECT_EQ(twice.mesh.triangles, cornerTetrahedron().triangles);
}

std::string lattice(const std::string& attributes, const std::string& lists) {
  return "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"9\" y=\"0\" "
         "z=\"0\"/></vertices>"
         "<b:beamlattice minlength=\"0.1\" " +
         attributes + ">" + lists + "</b:beamlattice></mesh>";
}
std::string beams(const std::string& attributes) {
  return "<b:beams><b:beam v1=\"0\" v2=\"1\" " + attributes + "/></b:beams>";
}
Reading latticeReading(const std::string& attributes, const std::string& lists) {
  return reading(readThreeMf, archive(model(object(1, lattice(attributes, lists)), item(1))));
}

TEST(ThreeMfReader, BeamLattices) {
  const double ball = 4 * kPi / 3;
  const auto expect = [&](const std::string& attributes, const std::string& lists, double volume) {
    const Reading read = latticeReading(attributes, lists);
    ASSERT_EQ(read.error, "");
    EXPECT_NEAR(meshes::signedVolume(read.mesh), volume, 1e-9 * volume) << attributes << lists;
    EXPECT_EQ(read.codes(), "");
    EXPECT_FALSE(read.report.partial);
  };
  expect(R"(radius="1" cap="butt")", beams(""), 9 * kPi);
  expect(R"(radius="1")", beams(""), 9 * kPi + 2 * ball);
  expect(R"(radius="1" cap="butt")", beams(R"(r1="2")"), 36 * kPi);
  expect(R"(radius="1" cap="butt")", beams(R"(r2="2")"), 21 * kPi);
  expect(R"(radius="1" cap="butt")", beams(R"(cap2="sphere")"), 9 * kPi + ball);
  expect(R"(radius="1" cap="butt" ballmode="all" ballradius="2")", beams(""), 9 * kPi + 16 * ball);
  expect(R"(radius="1" cap="butt" ballmode="mixed" ballradius="2")",
         beams("") + R"(<b:balls><b:ball vindex="1"/></b:balls>)", 9 * kPi + 8 * ball);
  expect(R"(radius="1" cap="butt" ballmode="mixed" ballradius="2")",
         beams("") + R"(<b:balls><b:ball vindex="1" r="3"/></b:balls>)", 9 * kPi + 27 * ball);
}

TEST(ThreeMfReader, WhatOfLatticesIsNotAsInTheFile) {
  const Reading bad = latticeReading(
      R"(radius="1")",
      beams("") + R"(<b:beams><b:beam v1="0" v2="7"/><b:beam v1="0" v2="1" r1="x"/></b:beams>)");
  EXPECT_EQ(bad.codes(), "beams");
  EXPECT_NE(bad.report.warnings[0].text.find("2 beams"), std::string::npos);
  EXPECT_TRUE(bad.report.partial);
  for (const char* attribute : {"clippingmode", "clipping"}) {
    const Reading clipped = latticeReading(
        std::string(R"(radius="1" clippingmesh="2" )") + attribute + "=\"inside\"", beams(""));
    EXPECT_EQ(clipped.codes(), "beams");
    EXPECT_NE(clipped.report.warnings[0].text.find("1 beams of lattices are whole"),
              std::string::npos);
    EXPECT_TRUE(clipped.report.partial);
  }
  // The mesh that represents a lattice is taken for it.
  const Reading shown = reading(
      readThreeMf,
      archive(model(
          object(2, kMesh) +
              object(
                  1,
                  lattice(
                      R"(radius="1" clippingmode="inside" clippingmesh="2" representationmesh="2")",
                      beams(""))),
          item(1, "2 0 0 0 1 0 0 0 1 0 0 0"))));
  EXPECT_EQ(shown.codes(), "");
  EXPECT_NEAR(meshes::signedVolume(shown.mesh), 2.0 / 6, 1e-12);
}

TEST(ThreeMfReader, Units) {
  const std::pair<const char*, const char*> units[] = {{"micron", "micrometre"},
                                                       {"millimeter", "millimetre"},
                                                       {"centimeter", "centimetre"},
                                                       {"inch", "inch"},
                                                       {"foot", "foot"},
                                                       {"meter", "metre"}};
  for (const auto& [theirs, ours] : units)
    EXPECT_EQ(reading(readThreeMf, archive(model(object(1, kMesh), item(1), theirs))).mesh.units,
              ours);
}

TEST(ThreeMfReader, WhatIsNotBuiltIsNotRead) {
  const Reading read =
      reading(readThreeMf, archive(model(object(1, kMesh) + object(2, kMesh), item(2))));
  EXPECT_EQ(read.mesh.triangleCount(), 4U);
  EXPECT_NE(reading(readThreeMf, archive(model(object(1, kMesh), ""))).error, "");
}

TEST(ThreeMfReader, BrokenModelsEndInOneSentence) {
  for (const std::string& text :
       {std::string("<model"), std::string("<other/>"), std::string(),
        model(object(1, "<mesh><vertices><x:vertex/></vertices></mesh>"), item(1)),
        model(object(1, kMesh), item(1, "1 2 3"))}) {
    const Reading read = reading(readThreeMf, archive(text));
    EXPECT_EQ(read.error.find("file"), 0U) << read.error;
    EXPECT_EQ(read.status, Status::Invalid);
  }
}

TEST(ThreeMfReader, WhatDoesNotExistIsLeftOut) {
  const Reading read = reading(readThreeMf, archive(model(object(1, kMesh) + object(2, "<other/>"),
                                                          item(7) + item(1) + item(2))));
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.triangleCount(), 4U);
  EXPECT_EQ(read.codes(), "missing-objects");
  EXPECT_TRUE(read.report.partial);
}

TEST(ThreeMfReader, FacesAndVerticesWithoutMeaning) {
  std::string mesh = kMesh;
  mesh.insert(mesh.find("</vertices>"), "<vertex x='1e400' y='0' z='0'/>");
  mesh.insert(mesh.find("</triangles>"),
              "<triangle v1='1' v2='1' v3='2'/>" // flat, but a face
              "<triangle v1='0' v2='1' v3='4'/>"
              "<triangle v1='0' v2='1' v3='5'/>"
              "<triangle v1='0' v2='1' v3='x'/><triangle v1='0' v2='1'/>");
  const Reading read = reading(readThreeMf, archive(model(object(1, mesh), item(1) + item(1))));
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.points.size(), 10U);
  EXPECT_EQ(read.mesh.triangleCount(), 10U);
  EXPECT_EQ(read.codes(), "bad-vertices bad-faces");
}

TEST(ThreeMfReader, OtherWaysToWriteXml) {
  // Prefixes, also ones that nothing declares, comments, quotes, names that extensions use too.
  std::string text = model(object(1, kMesh), item(1));
  text.insert(text.find("<resources>") + 11,
              "<!-- <object id='1'> --><s:slicestack id='9'><s:slice><s:vertices><s:vertex x='0' "
              "y='0'/></s:vertices></s:slice></s:slicestack><ms:unknown name='a > b'/>"
              "<![CDATA[ </model> ]]>");
  for (const char* name : {"mesh", "vertex", "vertices", "triangle", "triangles"})
    for (const char* mark : {"<", "</"})
      for (std::size_t at = 0; (at = text.find(std::string(mark) + name, at)) != text.npos; at += 9)
        text.insert(at + std::string(mark).size(), "c:");
  const Reading read = reading(readThreeMf, archive(text));
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.points, cornerTetrahedron().points);
  EXPECT_EQ(read.mesh.triangles, cornerTetrahedron().triangles);
}

TEST(ThreeMfReader, ManyNestedComponentsAreALimit) {
  std::string objects = object(1, kMesh);
  for (int i = 2; i < 9; ++i) {
    std::string list;
    for (int k = 0; k < 10; ++k)
      list += component(i - 1);
    objects += object(i, components(list));
  }
  const Reading read = reading(readThreeMf, archive(model(objects, item(8))));
  EXPECT_EQ(read.status, Status::Limit) << read.error;
}

TEST(ThreeMfReader, ObjectsThatContainThemselvesAreALimit) {
  const Reading read =
      reading(readThreeMf, archive(model(object(1, components(component(1))), item(1))));
  EXPECT_EQ(read.status, Status::Limit) << read.error;
}

TEST(ThreeMfReader, DeclaredSizesAreHeldAgainstTheFile) {
  const std::string bomb = archive(model(object(1, kMesh + std::string(100U << 20, ' ')), item(1)));
  const Reading read = reading(readThreeMf, bomb);
  EXPECT_EQ(read.status, Status::Limit) << read.error;
  EXPECT_NE(read.error.find("times the file's size"), std::string::npos) << read.error;
}

TEST(ThreeMfReader, DeclaredSizesMustBeTrue) {
  const std::string good = archive(model(object(1, kMesh + std::string(10000, ' ')), item(1)));
  EXPECT_EQ(reading(readThreeMf, good).error, "");
  const std::size_t entry = good.rfind("PK\x01\x02");
  for (const char first : {'\0', '\xff'}) {
    std::string lie = good;
    lie[entry + 24] = first;
    const Reading read = reading(readThreeMf, lie);
    EXPECT_EQ(read.status, Status::Invalid);
    EXPECT_NE(read.error.find("declared"), std::string::npos) << read.error;
  }
}

TEST(ThreeMfReader, DamagedArchives) {
  const std::string good = archive(model(object(1, kMesh), item(1)));
  for (std::size_t size = 0; size < good.size(); ++size) {
    const Reading read = reading(readThreeMf, good.substr(0, size));
    ASSERT_EQ(read.status, Status::Invalid) << size;
  }
}

TEST(ZipDirectory, Entries) {
  const std::string bytes = archive("hello hello hello hello");
  const Source source{bytes, "file"};
  const std::vector<ZipEntry> entries = readZipDirectory(source);
  ASSERT_EQ(entries.size(), 3U);
  EXPECT_EQ(entries[2].name, "3D/3dmodel.model");
  EXPECT_EQ(entries[2].unpacked, 23U);
  EXPECT_EQ(entries[2].method, 8);
  EXPECT_EQ(bytes.substr(entries[2].offset, 4), "PK\x03\x04");
  Progress progress;
  EXPECT_EQ(unpackZipEntry(entries[2], source, progress), "hello hello hello hello");
  checkZipSizes(entries, source);
  // The same bytes under many names are one of the ways to make a bomb.
  const std::vector<ZipEntry> overlapping(200, entries[2]);
  EXPECT_THROW(checkZipSizes(overlapping, source), Error);
}

} // namespace
} // namespace tetvdb
