// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "TemporaryFolder.h"
#include "tetvdb/geometry/Ownership.h"
#include "tetvdb/mesh/SpooledMesh.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SpooledBoundary.h"
#include "tetvdb/voxelize/TetRaster.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numeric>
#include <rapidcheck/gtest.h>
#include <tuple>

namespace {

using namespace tetvdb;

SnappedMesh snap(const TetMesh& mesh, const GridTransform& transform = {}) {
  Progress progress;
  return snapMesh(mesh, transform, progress);
}

// Faces by their sorted corners, with the sign of the order.
using Chain = std::map<std::array<std::uint32_t, 3>, int>;

void add(Chain& chain, std::uint32_t a, std::uint32_t b, std::uint32_t c, int weight) {
  std::array<std::uint32_t, 3> f{a, b, c};
  for (int pass = 0; pass < 2; ++pass)
    for (std::size_t i = 0; i < 2; ++i)
      if (f[i] > f[i + 1]) {
        std::swap(f[i], f[i + 1]);
        weight = -weight;
      }
  const auto it = chain.emplace(f, 0).first;
  it->second += weight;
  if (it->second == 0)
    chain.erase(it);
}

// Outward faces of all tets, added up one by one; the sign by plain 128-bit arithmetic.
Chain expected(const TetMesh& mesh, const SnappedMesh& snapped) {
  Chain chain;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    const std::uint32_t* v = mesh.tets.data() + 4 * t;
    __extension__ __int128 e[3][3];
    for (std::size_t i = 0; i < 3; ++i) {
      const LatticePoint &p = snapped.points[v[i + 1]], &o = snapped.points[v[0]];
      e[i][0] = static_cast<long long>(p.x - o.x);
      e[i][1] = static_cast<long long>(p.y - o.y);
      e[i][2] = static_cast<long long>(p.z - o.z);
    }
    const auto det = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                     e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                     e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
    if (det == 0)
      continue;
    const int s = det > 0 ? 1 : -1;
    add(chain, v[0], v[2], v[1], s);
    add(chain, v[0], v[1], v[3], s);
    add(chain, v[0], v[3], v[2], s);
    add(chain, v[1], v[2], v[3], s);
  }
  return chain;
}

void expectEqual(const Boundary& a, const Boundary& b) {
  ASSERT_EQ(a.flipped, b.flipped);
  ASSERT_EQ(a.dropped, b.dropped);
  ASSERT_EQ(a.faces.size(), b.faces.size());
  for (std::size_t i = 0; i < a.faces.size(); ++i) {
    const BoundaryFace &f = a.faces[i], &g = b.faces[i];
    ASSERT_EQ(std::tie(f.a, f.b, f.c, f.weight), std::tie(g.a, g.b, g.c, g.weight));
  }
}

// Of tets oriented by snapped points.
void expectCounts(const Boundary& boundary, const TetMesh& mesh, const SnappedMesh& snapped) {
  OrientationCounts counts;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    const std::uint32_t* v = mesh.tets.data() + 4 * t;
    counts.count(signOf(orientation(snapped.points[v[0]], snapped.points[v[1]],
                                    snapped.points[v[2]], snapped.points[v[3]])));
  }
  ASSERT_EQ(boundary.flipped, counts.flipped);
  ASSERT_EQ(boundary.dropped, counts.dropped);
}

void expectBoundary(const TetMesh& mesh, const GridTransform& transform = {}) {
  const SnappedMesh snapped = snap(mesh, transform);
  Progress progress;
  const Boundary boundary = boundaryFaces(snapped, progress);
  Chain found;
  for (const BoundaryFace& f : boundary.faces) {
    ASSERT_GT(f.weight, 0);
    add(found, f.a, f.b, f.c, f.weight);
  }
  ASSERT_EQ(found, expected(mesh, snapped));
  ASSERT_EQ(found.size(), boundary.faces.size());
  expectCounts(boundary, mesh, snapped);

  // Of points that are not snapped before, and of those that are used alone.
  Boundary unsnapped = boundaryFaces(mesh, transform, progress);
  expectEqual(unsnapped, boundary);
  const SnappedMesh some = snapUsed(mesh.points, unsnapped, transform, progress);
  std::vector<std::uint8_t> isUsed(mesh.points.size());
  for (std::size_t i = 0; i < boundary.faces.size(); ++i) {
    const BoundaryFace &whole = boundary.faces[i], &own = unsnapped.faces[i];
    ASSERT_EQ(whole.weight, own.weight);
    for (const auto& [v, w] : {std::pair(whole.a, own.a), {whole.b, own.b}, {whole.c, own.c}}) {
      const LatticePoint &p = snapped.points[v], &q = some.points[w];
      ASSERT_EQ(std::tie(p.x, p.y, p.z), std::tie(q.x, q.y, q.z));
      isUsed[v] = 1;
    }
  }
  ASSERT_EQ(some.pointCount, std::accumulate(isUsed.begin(), isUsed.end(), std::size_t(0)));

  // Of a mesh in files, in as many passes as little memory needs: the same faces in their order.
  const TemporaryFolder folder;
  SpooledMesh spooled(folder.path().string());
  spooled.points.append(mesh.points);
  spooled.tets.append(mesh.tets);
  spooled.finish();
  const SpooledBoundary same = spooledBoundary(spooled, transform, 1 << 12, 0, progress);
  ASSERT_EQ(same.chain.flipped, boundary.flipped);
  ASSERT_EQ(same.chain.dropped, boundary.dropped);
  ASSERT_EQ(same.chain.faces.size(), boundary.faces.size());
  std::map<std::uint32_t, std::uint32_t> used; // by place
  for (std::size_t i = 0; i < boundary.faces.size(); ++i) {
    const BoundaryFace &a = boundary.faces[i], &b = same.chain.faces[i];
    ASSERT_EQ(a.weight, b.weight);
    for (const auto& [whole, own] : {std::pair(a.a, b.a), {a.b, b.b}, {a.c, b.c}}) {
      ASSERT_LT(own, same.points.size());
      ASSERT_EQ(same.points[own], mesh.points[whole]);
      used.emplace(whole, own);
    }
  }
  std::uint32_t next = 0;
  for (const auto& [whole, own] : used)
    ASSERT_EQ(own, next++);
  ASSERT_EQ(same.points.size(), used.size());
}

TEST(BoundaryFaces, ABoxHasTwoTrianglesASquare) {
  const TetMesh mesh = meshes::scaled(meshes::kuhnGrid(7, 5, 3), 2);
  Progress progress;
  const Boundary boundary = boundaryFaces(snap(mesh), progress);
  EXPECT_EQ(boundary.faces.size(), 2u * 2u * (7 * 5 + 5 * 3 + 3 * 7));
  EXPECT_EQ(boundary.flipped, 0u);
  EXPECT_EQ(boundary.dropped, 0u);
  expectBoundary(mesh);
}

TEST(BoundaryFaces, OfManyPoints) {
  expectBoundary(meshes::ball(24, 100, {1, 2, 3}));
}

TEST(BoundaryFaces, AnyOrderOfTetsAndPoints) {
  for (std::uint64_t seed = 1; seed < 5; ++seed)
    expectBoundary(meshes::shuffled(meshes::ball(9, 30, {1, 2, 3}), seed));
}

TEST(BoundaryFaces, FlippedFlatAndDuplicateTets) {
  TetMesh mesh = meshes::scaled(meshes::kuhnGrid(4, 4, 4), 3);
  meshes::Random random(4);
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    if (random.below(3) == 0)
      std::swap(mesh.tets[4 * t], mesh.tets[4 * t + 1]);
    if (random.below(9) == 0)
      mesh.tets.insert(mesh.tets.end(), {mesh.tets[4 * t], mesh.tets[4 * t + 1],
                                         mesh.tets[4 * t + 2], mesh.tets[4 * t + 3]});
    if (random.below(9) == 0)
      mesh.tets.insert(mesh.tets.end(), {mesh.tets[4 * t], mesh.tets[4 * t + 1],
                                         mesh.tets[4 * t + 2], mesh.tets[4 * t + 2]});
  }
  expectBoundary(mesh);
}

// Few points and many tets: overlaps, faces of any weight.
RC_GTEST_PROP(BoundaryFacesProperties, SumsOfAnyTets, ()) {
  meshes::Random random(*rc::gen::arbitrary<std::uint32_t>());
  TetMesh mesh;
  const std::size_t points = 5 + random.below(30);
  for (std::size_t i = 0; i < points; ++i)
    mesh.points.push_back({random.between(0, 4), random.between(0, 4), random.between(0, 4)});
  for (std::size_t t = 0; t < 1 + random.below(200); ++t)
    for (int i = 0; i < 4; ++i)
      mesh.tets.push_back(static_cast<std::uint32_t>(random.below(points)));
  expectBoundary(mesh);
}

// Tets that floats do not decide, or only just: nearly flat ones whose sign depends on how points
// are snapped, among others, repeated and reversed ones; near the origin and where coordinates have
// no digits left.
TetMesh nearlyFlat(std::size_t count, const GridTransform& transform, const Vec3d& voxel,
                   std::uint64_t seed) {
  meshes::Random random(seed);
  TetMesh mesh;
  const auto add = [&](const Vec3d& inVoxels) {
    Vec3d p;
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = transform.origin[k] + (voxel[k] + inVoxels[k]) * transform.voxelSize[k];
    mesh.tets.push_back(static_cast<std::uint32_t>(mesh.points.size()));
    mesh.points.push_back(p);
  };
  for (std::size_t t = 0; t < count; ++t) {
    if (t > 8 && random.below(4) == 0) {
      const std::size_t of = 4 * random.below(mesh.tetCount());
      for (std::size_t k = 0; k < 4; ++k)
        mesh.tets.push_back(mesh.tets[of + k]);
      if (random.below(2) == 0)
        std::swap(mesh.tets.back(), mesh.tets[mesh.tets.size() - 2]);
      continue;
    }
    const double size = std::exp2(random.between(-18, 18));
    Vec3d corners[4];
    for (Vec3d& corner : corners)
      for (double& c : corner)
        c = random.between(-size, size);
    if (random.below(3) > 0) { // the fourth corner in the plane of the others, but for little
      const double s = random.between(-1, 1), r = random.between(-1, 1);
      const double off = random.below(4) == 0   ? 0
                         : random.below(2) == 0 ? std::exp2(random.between(-22, -12))
                                                : size * std::exp2(random.between(-30, -18));
      for (std::size_t k = 0; k < 3; ++k)
        corners[3][k] = corners[0][k] + s * (corners[1][k] - corners[0][k]) +
                        r * (corners[2][k] - corners[0][k]) + random.between(-off, off);
    }
    for (const Vec3d& corner : corners)
      add(corner);
  }
  return mesh;
}

TEST(BoundaryFaces, NearlyFlatTetsAnywhere) {
  std::uint64_t seed = 1;
  for (const Vec3d& size : {Vec3d{1, 1, 1}, Vec3d{0.1, 0.1, 0.1}, Vec3d{0.05, 0.05, 0.3},
                            Vec3d{1e-4, 2e-4, 3e-4}, Vec3d{3e7, 1e7, 2e7}})
    for (const Vec3d& voxel : {Vec3d{0, 0, 0}, Vec3d{1e3, -2e4, 3e5}, Vec3d{-2.1e9, 2.1e9, 2e9}}) {
      const GridTransform transform{size, {7 * size[0], -0.3, 0}};
      expectBoundary(nearlyFlat(500, transform, voxel, seed++), transform);
    }
}

TEST(BoundaryFaces, MeshesInAnyUnits) {
  for (const double unit : {1e-4, 0.3, 1e5, 1e9, 1e30}) {
    const TetMesh mesh = meshes::scaled(meshes::ball(6, 20, {1, 2, 3}), unit);
    expectBoundary(mesh, {{unit, unit, unit}, {0, 0, 0}});
    expectBoundary(mesh, {{unit, unit * 10, unit / 10}, {unit, 0, 0}});
  }
}

// The sums of all but one vertex are of tets around it: the last point, which is not read with the
// others, has any place.
TEST(BoundaryFaces, TheLastPointIsAnyCorner) {
  TetMesh mesh = meshes::ball(5, 20, {1, 2, 3});
  const auto last = static_cast<std::uint32_t>(mesh.points.size() - 1);
  for (std::uint32_t other = 0; other < last; other += 7) {
    TetMesh swapped = mesh;
    std::swap(swapped.points[other], swapped.points[last]);
    for (std::uint32_t& v : swapped.tets)
      v = v == other ? last : v == last ? other : v;
    expectBoundary(swapped);
  }
}

TEST(BoundaryFaces, LongTets) {
  expectBoundary(meshes::scaled(meshes::kuhnGrid(3, 2, 2), 0.9e6));
  expectBoundary(meshes::scaled(meshes::kuhnGrid(3, 2, 2), 0.5e6));
}

TEST(BoundaryFaces, RefusesTetsLongerThanTheLatticeAllows) {
  Progress progress;
  for (const int n : {1, 2}) { // in lanes, too
    TetMesh mesh = meshes::scaled(meshes::kuhnGrid(n, n, n), 1.1e6);
    mesh.points.push_back({0, 0, 0}); // tets that have the last point are not oriented in lanes
    EXPECT_THROW(boundaryFaces(snap(mesh), progress), Error);
    EXPECT_THROW(boundaryFaces(mesh, {}, progress), Error);
  }
}

} // namespace
