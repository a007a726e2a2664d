// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "TemporaryFolder.h"
#include "tetvdb/mesh/SpooledMesh.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SpooledBoundary.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <rapidcheck/gtest.h>

namespace {

using namespace tetvdb;

SnappedMesh snap(const TetMesh& mesh) {
  Progress progress;
  return snapMesh(mesh, {{1, 1, 1}, {0, 0, 0}}, progress);
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

void expectBoundary(const TetMesh& mesh) {
  const SnappedMesh snapped = snap(mesh);
  Progress progress;
  const Boundary boundary = boundaryFaces(snapped, progress);
  Chain found;
  for (const BoundaryFace& f : boundary.faces) {
    ASSERT_GT(f.weight, 0);
    add(found, f.a, f.b, f.c, f.weight);
  }
  ASSERT_EQ(found, expected(mesh, snapped));
  ASSERT_EQ(found.size(), boundary.faces.size());

  // Of a mesh in files, in as many passes as little memory needs: the same faces in their order.
  const TemporaryFolder folder;
  SpooledMesh spooled(folder.path().string());
  spooled.points.append(mesh.points);
  spooled.tets.append(mesh.tets);
  spooled.finish();
  const GridTransform transform{{1, 1, 1}, {0, 0, 0}};
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

TEST(BoundaryFaces, RefusesTetsLongerThanTheLatticeAllows) {
  Progress progress;
  const TetMesh mesh = meshes::scaled(meshes::kuhnGrid(1, 1, 1), 1.1e6);
  EXPECT_THROW(boundaryFaces(snap(mesh), progress), Error);
}

} // namespace
