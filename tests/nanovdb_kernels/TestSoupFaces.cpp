// SPDX-License-Identifier: Apache-2.0
//
// The device's steps for triangles, run by their twin on the host, against the CPU's voxelize().
#include "OpenSoupCases.h"
#include "nanovdb_kernels/AnySoup.h"
#include "tetvdb/core/Error.h"

#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <rapidcheck/gtest.h>

namespace {

using namespace tetvdb;
using nano::GridType;
using nano::Method;

constexpr FillRule kRules[] = {FillRule::Positive, FillRule::NonZero, FillRule::Odd};

nano::Job soupJob(GridType type, Method method, FillRule rule, const GridTransform& transform) {
  nano::Job job = jobFor(type, method, transform);
  job.rule = rule;
  return job;
}

// All rules by the boundary, one of them by dense masks.
void expectSame(const SoupCase& c, FillRule denseRule) {
  nano::HostTwin twin;
  for (const FillRule rule : kRules)
    for (const Method method : {Method::Boundary, Method::Dense}) {
      if (method == Method::Dense && !(c.dense && rule == denseRule))
        continue;
      const nano::Result result =
          twin.run(viewOf(c.mesh), soupJob(GridType::Bool, method, rule, c.transform));
      ASSERT_NE(result.bytes, nullptr) << c.name;
      EXPECT_EQ(result.counts.method, method);
      EXPECT_EQ(hashOf(result), cpuHash(c.mesh, rule, GridKind::Mask, c.transform))
          << c.name << ", rule " << int(rule) << ", method " << int(method);
    }
}

TEST(SoupFaces, GridsAreThoseOfTheCpu) {
  std::size_t i = 0;
  for (const SoupCase& c : soupCases(false))
    expectSame(c, kRules[i++ % std::size(kRules)]);
}

RC_GTEST_PROP(SoupFacesProperties, Soups, ()) {
  expectSame({"any", facesOf(meshes::anySoup())},
             *rc::gen::elementOf(std::vector(std::begin(kRules), std::end(kRules))));
}

TEST(SoupFaces, TypesOfGrids) {
  const TriangleMesh mesh = meshes::sphere({3, -70, 100}, 40.3, 12);
  nano::HostTwin twin;
  for (const Method method : {Method::Auto, Method::Boundary}) {
    const std::string mask = cpuHash(mesh, FillRule::Positive, GridKind::Mask, {});
    EXPECT_EQ(hashOf(twin.run(viewOf(mesh), jobFor(GridType::Mask, method, {}))), mask);
    EXPECT_EQ(hashOf(twin.run(viewOf(mesh), jobFor(GridType::Fog, method, {}))),
              cpuHash(mesh, FillRule::Positive, GridKind::Density, {}));
  }
  EXPECT_THROW(twin.run(viewOf(mesh), jobFor(GridType::Owner, Method::Auto, {})), Error);
}

TEST(SoupFaces, SharesMakeTheSameBuffer) {
  const TriangleMesh mesh = movedBy(meshes::torus(), 60, {0, 0, 0});
  for (const Method method : {Method::Boundary, Method::Dense}) {
    nano::HostTwin one, several;
    const nano::Job job = jobFor(GridType::Fog, method, {});
    const nano::Result whole = one.run(viewOf(mesh), job);
    for (const int shares : {2, 3, 7})
      EXPECT_TRUE(sameBytes(several.run(viewOf(mesh), job, shares), whole)) << shares;
  }
}

// Edges as voxelize/SoupBoundary.h counts them.
TEST(SoupFaces, OpenSoupsMakeNoGrid) {
  const TriangleMesh sphere = meshes::sphere({0, 0, 0}, 20, 8);
  const TriangleMesh holed = meshes::without(sphere, [](std::size_t f) { return f == 3; });
  TriangleMesh repeated = sphere; // a face with a repeated point has one edge there and back
  meshes::addTriangle(repeated, 4, 4, 9);
  nano::HostTwin twin;
  for (const Method method : {Method::Boundary, Method::Dense})
    for (const int shares : {1, 3}) {
      const nano::Job job = jobFor(GridType::Mask, method, {});
      const nano::Result open = twin.run(viewOf(holed), job, shares);
      EXPECT_EQ(open.bytes, nullptr);
      EXPECT_EQ(open.counts.openEdges, 3u);
      EXPECT_EQ(open.counts.oddEdges, 3u);
      EXPECT_NE(twin.run(viewOf(repeated), job, shares).bytes, nullptr);
    }
  // Faces turned at random: every edge has two faces, parity does not ask which way they look.
  const TriangleMesh turned = meshes::withFacesFlipped(sphere, 0.3, 5);
  for (const Method method : {Method::Boundary, Method::Dense}) {
    const nano::Result none = twin.run(viewOf(turned), jobFor(GridType::Mask, method, {}));
    EXPECT_EQ(none.bytes, nullptr);
    EXPECT_GT(none.counts.openEdges, 0u);
    EXPECT_EQ(none.counts.oddEdges, 0u);
    const nano::Result made =
        twin.run(viewOf(turned), soupJob(GridType::Mask, method, FillRule::Odd, {}));
    ASSERT_NE(made.bytes, nullptr);
    EXPECT_EQ(hashOf(made), cpuHash(turned, FillRule::Odd, GridKind::Mask, {}));
  }
}

void expectSameOpen(const SoupCase& c, FillRule rule) {
  nano::HostTwin twin;
  FilledSoup soup(c.mesh, c.transform);
  const nano::Result result =
      twin.run(soup.view, soupJob(GridType::Bool, Method::Auto, rule, c.transform));
  ASSERT_NE(result.bytes, nullptr) << c.name;
  EXPECT_GT(result.counts.openEdges, 0u) << c.name;
  EXPECT_EQ(hashOf(result), cpuHash(c.mesh, rule, GridKind::Mask, c.transform))
      << c.name << ", rule " << int(rule);
}

TEST(SoupFaces, OpenSoupsAreThoseOfTheCpu) {
  std::size_t i = 0;
  for (const SoupCase& c : openSoupCases(false))
    expectSameOpen(c, i++ % 2 == 0 ? FillRule::Positive : FillRule::NonZero);
}

TEST(SoupFaces, OpenSoupsInSharesMakeTheSameBuffer) {
  const TriangleMesh mesh = movedBy(meshes::torus(), 60, {0, 0, 0});
  const TriangleMesh open = meshes::without(mesh, [](std::size_t f) { return f % 3 == 0; });
  FilledSoup soup(open, {});
  nano::HostTwin one, several;
  const nano::Job job = jobFor(GridType::Fog, Method::Auto, {});
  const nano::Result whole = one.run(soup.view, job);
  ASSERT_NE(whole.bytes, nullptr);
  for (const int shares : {2, 3})
    EXPECT_TRUE(sameBytes(several.run(soup.view, job, shares), whole)) << shares;
}

TEST(SoupFaces, RefusesWhatItCannotDo) {
  const auto statusOf = [](const TriangleMesh& mesh, Method method, double voxel = 1) {
    nano::HostTwin twin;
    try {
      twin.run(viewOf(mesh), jobFor(GridType::Mask, method, {{voxel, voxel, voxel}, {0, 0, 0}}));
    } catch (const Error& e) {
      return e.status();
    }
    return Status::Ok;
  };
  TriangleMesh mesh = meshes::box();
  EXPECT_EQ(statusOf(mesh, Method::Boundary, 1e-7), Status::Limit); // a triangle of 10^7 voxels
  EXPECT_EQ(statusOf(meshes::box({0, 0, 0}, {2200, 2200, 2200}), Method::Dense), Status::Limit);
  mesh.points[3][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(statusOf(mesh, Method::Auto), Status::Limit);
  for (const Method method : {Method::Boundary, Method::Dense}) {
    mesh = meshes::box();
    mesh.triangles[5] = static_cast<std::uint32_t>(mesh.points.size());
    EXPECT_EQ(statusOf(mesh, method), Status::Invalid);
  }
}

} // namespace
