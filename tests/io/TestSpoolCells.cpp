// SPDX-License-Identifier: Apache-2.0
//
// What is read part by part is what is read as a whole.
#include "Meshes.h"
#include "TemporaryFolder.h"
#include "io/SpooledSame.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/io/SpoolCells.h"
#include "tetvdb/io/formats/vtk/VtuData.h"
#include "tetvdb/io/formats/vtk/VtuLayout.h"
#include "tetvdb/io/source/Source.h"

#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>

namespace {

using namespace tetvdb;
using test::expectSpooledSame;

TetMesh withArrays(TetMesh mesh) {
  std::vector<double> heat(mesh.points.size());
  std::vector<std::int32_t> material(mesh.tetCount());
  for (std::size_t i = 0; i < heat.size(); ++i)
    heat[i] = 0.5 * static_cast<double>(i % 1000);
  for (std::size_t i = 0; i < material.size(); ++i)
    material[i] = static_cast<std::int32_t>(i / 999 % 7);
  mesh.regions = material;
  mesh.attributes = {{"heat", Attribute::On::Points, 1, heat},
                     {"material", Attribute::On::Cells, 1, material}};
  return mesh;
}

// More points and tets than are read at a time.
TEST(SpoolCells, LargeFiles) {
  const TemporaryFolder folder;
  const TetMesh mesh = withArrays(meshes::jittered(meshes::kuhnGrid(101, 101, 20), 0.2, 3));
  ASSERT_GT(mesh.tetCount(), std::size_t(1) << 20);
  Progress progress;
  for (const char* name : {"a.vtu", "a.msh"}) {
    writeTetMesh(folder / name, mesh, progress);
    expectSpooledSame(folder / name);
    ReadOptions options;
    options.arrays = {"heat"};
    expectSpooledSame(folder / name, options);
    options.attributes = false;
    expectSpooledSame(folder / name, options);
  }
}

TEST(SpoolCells, CellsOfSeveralKinds) {
  expectSpooledSame(TETVDB_TEST_DATA "/hybrid_tetwedge.msh");
  // More than are cut at a time, no two of a kind one after the other.
  const TemporaryFolder folder;
  SpooledMesh spooled(folder.path().string());
  CellMesh cells;
  for (int level = 0; level < 2; ++level)
    for (int i = 0; i < 6; ++i)
      cells.points.push_back({std::cos(i * 1.0471975511965976), std::sin(i * 1.0471975511965976),
                              static_cast<double>(level)});
  spooled.points.append(cells.points);
  const std::vector<std::uint32_t> five{0, 1, 2, 3, 4, 6, 7, 8, 9, 10}, tet{0, 1, 2, 6},
      six{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const auto add = [&](CellType type, const std::vector<std::uint32_t>& nodes, const char* name) {
    cells.runs.push_back({type, static_cast<std::uint32_t>(nodes.size()), 1, name});
    cells.nodes.insert(cells.nodes.end(), nodes.begin(), nodes.end());
    spooled.addCells(type, nodes.data(), 1);
  };
  for (int i = 0; i < 9000; ++i) {
    add(CellType::Tetra, tet, "tetra");
    add(CellType::PentagonalPrism, five, "five");
    add(CellType::HexagonalPrism, six, "six");
  }
  Report report;
  Progress progress;
  splitSpooled(spooled, report, progress);
  spooled.finish();
  const TetMesh whole = splitCells(std::move(cells), {}, report, progress);
  EXPECT_EQ(test::valuesOf<std::uint32_t>(spooled.tets), whole.tets);
  EXPECT_EQ(test::valuesOf<std::uint32_t>(spooled.cellOfTet), whole.cellOfTet);
}

// Every array of the samples, in steps of odd lengths.
TEST(SpoolCells, ArraysOfAnyEncodingOneAfterTheOther) {
  std::size_t arrays = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TETVDB_TEST_DATA "/vtk")) {
    const std::string path = entry.path().string();
    if (entry.path().extension() != ".vtu")
      continue;
    const MappedFile file(path);
    const Source source = file.source();
    const vtk::VtuLayout layout(source);
    Progress progress;
    for (const pugi::xml_node piece : layout.pieces()) {
      const std::size_t points = layout.count(piece, "NumberOfPoints");
      const pugi::xml_node node = piece.child("Points").child("DataArray");
      if (points == 0)
        continue;
      const vtk::ArrayPlace place = layout.locate(node, 3 * points);
      if (place.isText)
        continue;
      const std::uint64_t bytes = vtk::bytesFor(place.type, 3 * points);
      const vtk::Decoded whole =
          vtk::decode(place.from, place.base64, layout.encoding(), bytes, path, progress);
      vtk::ArrayStream stream(place.from, place.base64, layout.encoding(), path);
      ASSERT_EQ(stream.left(), whole.size);
      std::string all;
      for (std::uint64_t step = 1; stream.left() > 0; step = step * 2 + 1) {
        std::string some(static_cast<std::size_t>(std::min(step, stream.left())), '\0');
        stream.read(some.data(), some.size());
        all += some;
      }
      EXPECT_TRUE(all == std::string(whole.data, static_cast<std::size_t>(whole.size))) << path;
      char one = 0;
      EXPECT_THROW(stream.read(&one, 1), Error);
      ++arrays;
    }
  }
  EXPECT_GT(arrays, 10u);
}

TEST(SpoolCells, OtherCellsAndFormatsAreRefused) {
  const TemporaryFolder folder;
  const auto refuse = [&](const std::string& name, Status status) {
    Progress progress;
    Report report;
    SpooledMesh spooled(folder.path().string());
    FileFormat format = FileFormat::Unknown;
    try {
      spoolCells(TETVDB_TEST_DATA "/" + name, {}, spooled, format, report, progress);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), status) << error.what();
    }
  };
  refuse("vtk/mixed_raw_none_64_little.vtu", Status::Invalid); // polyhedra among them
  refuse("quadratic_sphere_tet.msh", Status::Invalid);
  refuse("octahedron.ele", Status::Usage);
}

} // namespace
