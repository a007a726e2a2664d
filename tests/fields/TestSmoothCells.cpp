// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/fields/SmoothCells.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <set>

namespace {

using namespace tetvdb;

// Cells of six tets each, so that a point is in several tets of a cell.
TetMesh cubes(int n) {
  TetMesh mesh = meshes::kuhnGrid(n, n, n);
  mesh.cellOfTet.clear();
  for (std::size_t t = 0; t < mesh.tetCount(); ++t)
    mesh.cellOfTet.push_back(static_cast<std::uint32_t>(t / 6));
  mesh.cellCount = mesh.tetCount() / 6;
  return mesh;
}

TEST(SmoothCells, EveryPointHasTheMeanOfItsCells) {
  TetMesh mesh = cubes(3);
  mesh.points.push_back({9, 9, 9}); // in no cell
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<float> one(mesh.cellCount, 0.1F), vectors;
  std::vector<double> holes;
  std::vector<std::int32_t> kinds;
  for (std::size_t c = 0; c < mesh.cellCount; ++c) {
    vectors.insert(vectors.end(), {float(c), float(c * c), -1});
    holes.push_back(c % 3 == 0 ? nan : double(c));
    kinds.push_back(static_cast<std::int32_t>(c));
  }
  const auto onCells = [&](const char* name, std::uint32_t components, Attribute::Values values) {
    mesh.attributes.push_back({name, Attribute::On::Cells, components, std::move(values)});
  };
  onCells("one", 1, one);
  onCells("vectors", 3, vectors);
  onCells("holes", 1, holes);
  onCells("kinds", 1, kinds);
  onCells("both", 1, holes);
  mesh.attributes.push_back(
      {"both", Attribute::On::Points, 1, std::vector<float>(mesh.points.size(), 3)});
  const TetMesh before = mesh;
  smoothCells(mesh);
  ASSERT_EQ(mesh.attributes.size(), 6u);
  for (const std::size_t i : {0u, 1u, 2u})
    EXPECT_EQ(mesh.attributes[i].on, Attribute::On::Points);
  for (const std::size_t i : {3u, 4u})
    EXPECT_EQ(mesh.attributes[i].on, Attribute::On::Cells);
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    std::set<std::uint32_t> cells;
    for (std::size_t t = 0; t < mesh.tetCount(); ++t)
      for (std::size_t k = 0; k < 4; ++k)
        if (mesh.tets[4 * t + k] == p)
          cells.insert(mesh.cell(t));
    double square = 0, hole = 0, holesSeen = 0;
    for (const std::uint32_t c : cells) {
      square += double(c) * c / double(cells.size());
      if (c % 3 != 0) {
        hole += c;
        ++holesSeen;
      }
    }
    EXPECT_EQ(mesh.attributes[0].number(p), cells.empty() ? 0 : double(0.1F));
    EXPECT_NEAR(mesh.attributes[1].number(p, 1), square, 1e-4);
    if (cells.empty())
      EXPECT_EQ(mesh.attributes[2].number(p), 0);
    else if (holesSeen == 0)
      EXPECT_TRUE(std::isnan(mesh.attributes[2].number(p)));
    else
      EXPECT_DOUBLE_EQ(mesh.attributes[2].number(p), hole / holesSeen);
  }
  EXPECT_EQ(mesh.tets, before.tets);
}

} // namespace
