// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/CanonicalOrder.h"
#include "tetvdb/surface/GroupWinding.h"
#include "tetvdb/surface/SolidField.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace meshes;

// The oracle sums solid angles of the group's faces one by one.
TEST(GroupWinding, AgreesWithSolidAngles) {
  const TriangleMesh mesh =
      joined({sphere(), without(torus(), [](std::size_t face) { return face % 9 == 0; }), sheet()});
  std::vector<std::uint32_t> group(mesh.triangleCount());
  std::vector<std::uint8_t> turned(mesh.triangleCount());
  Random random(8);
  for (std::size_t face = 0; face < group.size(); ++face) {
    group[face] = face % 11 == 0 ? EdgeTable::kNone : std::uint32_t(face * 3 / group.size());
    turned[face] = random.unit() < 0.2;
  }
  const WindingSamples samples = windingSamples(mesh, group, 3, 300);
  EXPECT_GT(samples.points.size(), 200u);
  EXPECT_LE(samples.points.size(), 320u);
  Progress progress;
  const GroupWinding winding(mesh, EdgeTable(mesh), TriangleScene(mesh), group, 3, turned,
                             samples.points, progress);
  for (std::uint32_t g = 0; g < 3; ++g) {
    TriangleMesh own = mesh;
    for (std::size_t face = 0; face < group.size(); ++face)
      if (turned[face])
        flipFace(own, face);
    own = without(own, [&](std::size_t face) { return group[face] != g; });
    for (std::size_t i = 0; i < samples.points.size(); ++i)
      EXPECT_NEAR(winding.of(g)[i], windingNumberAt(own, samples.points[i]), 1e-4) << g << " " << i;
  }
}

TEST(SolidField, DistanceFromSolid) {
  EXPECT_FLOAT_EQ(distanceFromSolid(0.0f), 0.0f);
  EXPECT_FLOAT_EQ(distanceFromSolid(2.0f), 0.0f);
  EXPECT_FLOAT_EQ(distanceFromSolid(0.5f), 0.5f);
  EXPECT_FLOAT_EQ(distanceFromSolid(-0.25f), 0.25f);
  EXPECT_FLOAT_EQ(distanceFromSolid(-3.0f), 1.0f);
}

TEST(CanonicalOrder, IsTheSameForEveryOrder) {
  const TriangleMesh mesh = torus();
  TriangleMesh other = shuffledFaces(mesh, 5);
  const auto n = static_cast<std::uint32_t>(mesh.points.size());
  for (std::uint32_t i = 0; i < n; ++i)
    other.points[i] = mesh.points[(i * 5 + 3) % n];
  std::vector<std::uint32_t> place(n);
  for (std::uint32_t i = 0; i < n; ++i)
    place[(i * 5 + 3) % n] = i;
  for (std::uint32_t& corner : other.triangles)
    corner = place[corner];
  const CanonicalOrder a = canonicalOrder(mesh), b = canonicalOrder(other);
  EXPECT_EQ(a.mesh.points, b.mesh.points);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  for (std::size_t face = 0; face < a.faceWas.size(); ++face) {
    Vec3d sum{0, 0, 0}, was{0, 0, 0};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        sum[axis] += b.mesh.points[b.mesh.triangles[3 * face + k]][axis];
        was[axis] += other.points[other.triangles[3 * std::size_t(b.faceWas[face]) + k]][axis];
      }
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(sum[axis], was[axis], 1e-12);
  }
}

} // namespace
} // namespace tetvdb
