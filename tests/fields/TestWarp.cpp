// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/fields/Warp.h"

#include <gtest/gtest.h>
#include <limits>

namespace {

using namespace tetvdb;

TetMesh withVectors() {
  TetMesh mesh = meshes::kuhnGrid(2, 1, 1);
  std::vector<float> vectors;
  for (const Vec3d& p : mesh.points)
    vectors.insert(vectors.end(), {float(p[1]), 0.5f, float(-p[0])});
  mesh.attributes.push_back({"disp", Attribute::On::Points, 3, std::move(vectors)});
  return mesh;
}

TEST(Warp, MovesEveryPointByItsVector) {
  const TetMesh before = withVectors();
  TetMesh mesh = before;
  warpPoints(mesh, {"disp", -2});
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Vec3d& p = before.points[i];
    EXPECT_EQ(mesh.points[i], (Vec3d{p[0] - 2 * p[1], p[1] - 1, p[2] + 2 * p[0]}));
  }
  warpPoints(mesh, {});
  EXPECT_EQ(mesh.tets, before.tets);
}

TEST(Warp, NeedsFiniteVectorsAtThePoints) {
  const auto refused = [](TetMesh mesh, const char* name) {
    try {
      warpPoints(mesh, {name, 1});
    } catch (const Error& error) {
      return error.status();
    }
    return Status::Ok;
  };
  TetMesh mesh = withVectors();
  EXPECT_EQ(refused(mesh, "nope"), Status::Usage);
  mesh.attributes.push_back(
      {"T", Attribute::On::Points, 1, std::vector<double>(mesh.points.size())});
  mesh.attributes.push_back(
      {"c", Attribute::On::Cells, 3, std::vector<double>(3 * mesh.cellCount)});
  EXPECT_EQ(refused(mesh, "T"), Status::Usage);
  EXPECT_EQ(refused(mesh, "c"), Status::Usage);
  std::get<std::vector<float>>(mesh.attributes[0].values)[4] =
      std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(refused(mesh, "disp"), Status::Invalid);
}

} // namespace
