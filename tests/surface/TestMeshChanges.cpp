// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/MeshChanges.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

void expectChanges(const TriangleMesh& a, const TriangleMesh& b, std::size_t kept,
                   std::size_t removed, std::size_t added) {
  const MeshChanges changes = meshChanges(a, b);
  EXPECT_EQ(changes.kept, kept);
  EXPECT_EQ(changes.removed, removed);
  EXPECT_EQ(changes.added, added);
}

TEST(MeshChanges, NumberingOrderAndSideDoNotMatter) {
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 5);
  const std::size_t n = ball.triangleCount();
  expectChanges(ball, ball, n, 0, 0);
  expectChanges(ball, shuffledFaces(flipped(unwelded(ball))), n, 0, 0);
}

TEST(MeshChanges, FacesAreCounted) {
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 5);
  const std::size_t n = ball.triangleCount();
  const TriangleMesh some = without(ball, [](std::size_t f) { return f % 10 == 3; });
  expectChanges(ball, some, n - n / 10, n / 10, 0);
  expectChanges(some, ball, n - n / 10, 0, n / 10);
  expectChanges(joined({ball, ball}), ball, n, n, 0);
  const auto higher = [&](double by) {
    return moved(ball, [&](const Vec3d& p) { return Vec3d{p[0], p[1], p[2] * (1 + by)}; });
  };
  EXPECT_LT(meshChanges(ball, higher(1e-6)).kept, n);
  EXPECT_EQ(meshChanges(ball, higher(1e-15)).kept, n); // the same as 32-bit floats
  expectChanges(ball, {}, 0, n, 0);
}

} // namespace
} // namespace tetvdb
