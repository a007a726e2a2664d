// SPDX-License-Identifier: Apache-2.0
#include "io/VtkTestMesh.h"
#include "tetvdb/io/formats/exodus/ExodusReader.h"

namespace tetvdb::test {

TEST(ExodusReader, BlocksAreRegions) {
  const CellMesh mesh = read(readExodus, fileBytes(dataPath("petsc__FourBrickTet-large.exo")));
  EXPECT_EQ(mesh.points.size(), 34u);
  EXPECT_EQ(mesh.cellCount(), 89u);
  EXPECT_EQ(mesh.regions.size(), 89u);
  EXPECT_EQ(mesh.nodes.size(), 4u * 89);
  double sum = 0;
  for (const std::uint32_t node : mesh.nodes)
    sum += mesh.points[node][0] + 2 * mesh.points[node][1] + 3 * mesh.points[node][2];
  EXPECT_NEAR(sum, -3.33583386939, 1e-8);
}

class ExodusMixed : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(ClassicAndHdf5, ExodusMixed,
                         ::testing::Values("mixed.exo", "mixed_hdf5.exo"));

TEST_P(ExodusMixed, NodalAndElementVariables) {
  Report report;
  const CellMesh mesh = read(readExodus, fileBytes(dataPath(GetParam())), report, GetParam());
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(mesh.points, expectedPoints());
  EXPECT_EQ(mesh.cellCount(), 9u);
  EXPECT_EQ(mesh.nodes.size(), 3u * 4 + 10 + 8 + 6 + 5);
  const Attribute* t = find(mesh, "T", Attribute::On::Points);
  const Attribute* z = find(mesh, "flow speedZ", Attribute::On::Points);
  const Attribute* material = find(mesh, "material", Attribute::On::Cells);
  ASSERT_TRUE(t && z && material);
  ASSERT_EQ(t->size(), 20u);
  EXPECT_EQ(t->number(19), 6.5);
  EXPECT_NEAR(z->number(7), 7, 1e-6);
  ASSERT_EQ(material->size(), 9u);
  double sum = 0;
  for (std::size_t i = 0; i < 9; ++i)
    sum += material->number(i);
  EXPECT_EQ(sum, 18);
}

TEST_P(ExodusMixed, Times) {
  Report report;
  Progress progress;
  const std::string bytes = fileBytes(dataPath(GetParam()));
  EXPECT_EQ(exodusTimes({bytes, GetParam()}, report, progress), std::vector<double>{0});
}

TEST(ExodusReader, WithoutAttributes) {
  ReadOptions options;
  options.attributes = false;
  Report report;
  const CellMesh mesh =
      read(readExodus, fileBytes(dataPath("mixed.exo")), report, "mixed.exo", options);
  EXPECT_TRUE(mesh.attributes.empty());
  EXPECT_EQ(mesh.regions.size(), 9u);
}

TEST_P(ExodusMixed, TimesOfItsSteps) {
  const std::string bytes = fileBytes(dataPath(GetParam()));
  Report report;
  Progress progress;
  const std::vector<double> times = exodusTimes({bytes, GetParam()}, report, progress);
  ASSERT_FALSE(times.empty());
  for (std::size_t i = 1; i < times.size(); ++i)
    EXPECT_GT(times[i], times[i - 1]);
}

TEST_P(ExodusMixed, OnlyWantedVariables) {
  ReadOptions options;
  options.arrays = {"T"};
  Report report;
  const CellMesh mesh =
      read(readExodus, fileBytes(dataPath(GetParam())), report, GetParam(), options);
  ASSERT_EQ(mesh.attributes.size(), 1u);
  EXPECT_EQ(mesh.attributes[0].name, "T");
  EXPECT_GE(mesh.unread.size(), 4u); // three components of a vector and a material
}

TEST(ExodusReader, Hdf5CanBeCancelled) { // it is read in another process
  Progress progress;
  progress.cancel();
  Report report;
  const std::string bytes = fileBytes(dataPath("mixed_hdf5.exo"));
  EXPECT_THROW(readExodus({bytes, "test"}, {}, report, progress), Error);
}

TEST(ExodusReader, TruncatedIsRefused) {
  for (const std::string& name : dataFiles("", ".exo"))
    expectTruncatedIsRefused(readExodus, dataPath(name));
}

// Found by fuzzing: 117 million names of variables were looked up.
TEST(ExodusReader, BlocksThatAreDeclaredAreLimited) {
  // NetCDF's classic header with one dimension, without attributes and variables.
  std::string bytes = std::string("CDF\1\0\0\0\0\0\0\0\x0a\0\0\0\1\0\0\0\x0a", 20) + "num_el_blk" +
                      std::string("\0\0\7\0\0\7", 6);
  bytes.resize(256);
  Report report;
  Progress progress;
  try {
    exodusHasSolidCells({bytes, "test"}, report, progress);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("element blocks are declared"), std::string::npos)
        << error.what();
  }
}

TEST(ExodusReader, DamageIsHarmless) {
  for (const std::string& name : dataFiles("", ".exo"))
    expectDamageIsHarmless(readExodus, dataPath(name), name == "mixed_hdf5.exo" ? 60 : 1000);
}

} // namespace tetvdb::test
