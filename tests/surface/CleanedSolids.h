// SPDX-License-Identifier: Apache-2.0
//
// What the tests of cleanTriangles() ask of its results.
#pragma once

#include "TriangleMeshes.h"
#include "tetvdb/surface/CleanTriangles.h"

#include <algorithm>
#include <cstddef>
#include <gtest/gtest.h>
#include <vector>

namespace tetvdb::meshes {

inline CleanCounts clean(TriangleMesh& mesh, const CleanOptions& options = {}) {
  Progress progress;
  return cleanTriangles(mesh, options, progress);
}

inline TriangleMesh cleaned(TriangleMesh mesh) {
  clean(mesh);
  return mesh;
}

/// Points of the box from -2 to 3, away from the round numbers that the solids here begin at.
inline std::vector<Vec3d> probes(std::size_t count = 400) {
  Random random(11);
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back({random.between(-2, 3), random.between(-2, 3), random.between(-2, 3)});
  return points;
}

/// Whether the winding number says the same as `expected` about what is solid.
template <typename Expected>
void expectSolid(const TriangleMesh& mesh, const Expected& expected) {
  int wrong = 0;
  for (const Vec3d& p : probes())
    wrong += (windingNumberAt(mesh, p) > 0.5) != expected(p);
  EXPECT_EQ(wrong, 0);
}

inline void expectSameSolid(const TriangleMesh& mesh, const TriangleMesh& other) {
  expectSolid(mesh, [&](const Vec3d& p) { return windingNumberAt(other, p) > 0.5; });
}

inline auto inBox(double low, double high) {
  return [=](const Vec3d& p) {
    return std::min({p[0], p[1], p[2]}) > low && std::max({p[0], p[1], p[2]}) < high;
  };
}

/// Of triangles, about the origin.
inline TriangleMesh ball(double radius, bool inward = false) {
  const TriangleMesh mesh = sphere({0, 0, 0}, radius, 16);
  return inward ? flipped(mesh) : mesh;
}

} // namespace tetvdb::meshes
