// SPDX-License-Identifier: Apache-2.0
#include "io/VtkTestMesh.h"
#include "tetvdb/io/formats/vtk/PvtuReader.h"

namespace tetvdb::test {

TEST(PvtuReader, PiecesAreFoundBesideTheFileAndJoined) {
  const std::string path = dataPath("pieces.pvtu");
  Report report;
  const CellMesh mesh = read(readPvtu, fileBytes(path), report, path);
  EXPECT_EQ(mesh.points.size(), 2 * expectedPoints().size());
  EXPECT_EQ(mesh.cellCount(), 10u);
  EXPECT_EQ(mesh.nodes.size(), 43u + 6) << "one tet keeps its six mids";
  EXPECT_EQ(mesh.nodes[12], 21u) << "the wedge of the second piece";
  const Attribute* material = find(mesh, "material", Attribute::On::Cells);
  ASSERT_TRUE(material);
  EXPECT_EQ(material->size(), 10u);
  EXPECT_TRUE(report.warnings.empty()) << report.warnings[0].text;
}

TEST(PvtuReader, MissingPieceIsNamed) {
  const std::string text = "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid>"
                           "<Piece Source=\"absent.vtu\"/></PUnstructuredGrid></VTKFile>";
  EXPECT_NE(errorOf(readPvtu, text).find("absent.vtu"), std::string::npos);
}

TEST(PvtuReader, OtherFiles) {
  for (const char* text :
       {"", "x", "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid/></VTKFile>",
        "<VTKFile><PUnstructuredGrid></PUnstructuredGrid></VTKFile>",
        "<VTKFile><PUnstructuredGrid><Piece/></PUnstructuredGrid></VTKFile>"})
    EXPECT_FALSE(errorOf(readPvtu, text).empty()) << text;
}

TEST(PvtuReader, DamageIsHarmless) {
  expectDamageIsHarmless(readPvtu, dataPath("pieces.pvtu"), 500);
}

} // namespace tetvdb::test
