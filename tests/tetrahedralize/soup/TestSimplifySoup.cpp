// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/soup/SimplifySoup.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <set>
#include <tbb/global_control.h>

namespace tetvdb {
namespace {

constexpr double kScale = 0x1p32; // lattice units a unit of the test's meshes

LatticeSoup soupOf(const TriangleMesh& mesh, std::uint16_t input = 0) {
  LatticeSoup soup;
  for (const Vec3d& p : mesh.points)
    soup.points.push_back(roundToLattice(times(p, kScale)));
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    soup.faces.push_back({mesh.triangles[i], mesh.triangles[i + 1], mesh.triangles[i + 2]});
    soup.inputs.push_back(input);
  }
  return soup;
}

double distanceToSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d ab = minus(b, a);
  const double square = dot(ab, ab);
  const double at = square > 0 ? std::clamp(dot(minus(p, a), ab) / square, 0.0, 1.0) : 0;
  return length(minus(p, plus(a, times(ab, at))));
}

double distanceToFace(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d normal = cross(minus(b, a), minus(c, a));
  const auto isLeft = [&](const Vec3d& u, const Vec3d& v) {
    return dot(cross(minus(v, u), minus(p, u)), normal) >= 0;
  };
  if (dot(normal, normal) > 0 && isLeft(a, b) && isLeft(b, c) && isLeft(c, a))
    return std::abs(dot(normal, minus(p, a))) / length(normal);
  return std::min(
      {distanceToSegment(p, a, b), distanceToSegment(p, b, c), distanceToSegment(p, c, a)});
}

double distanceTo(const LatticeSoup& soup, const Vec3d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& f : soup.faces)
    best =
        std::min(best, distanceToFace(p, soup.points[f[0]], soup.points[f[1]], soup.points[f[2]]));
  return best;
}

// The largest distance from places on one soup's faces to another soup.
double farthest(const LatticeSoup& from, const LatticeSoup& to, int cuts) {
  double maxValue = 0;
  for (const auto& f : from.faces)
    for (int i = 0; i <= cuts; ++i)
      for (int j = 0; i + j <= cuts; ++j) {
        const Vec3d p = plus(times(from.points[f[0]], double(i) / cuts),
                             plus(times(from.points[f[1]], double(j) / cuts),
                                  times(from.points[f[2]], double(cuts - i - j) / cuts)));
        maxValue = std::max(maxValue, distanceTo(to, p));
      }
  return maxValue;
}

using Edges = std::map<std::pair<std::uint32_t, std::uint32_t>, int>;
Edges edgesOf(const LatticeSoup& soup) {
  Edges edges;
  for (const auto& f : soup.faces)
    for (std::size_t k = 0; k < 3; ++k)
      ++edges[std::minmax(f[k], f[(k + 1) % 3])];
  return edges;
}

long eulerCharacteristic(const LatticeSoup& soup) {
  return long(soup.points.size()) - long(edgesOf(soup).size()) + long(soup.faces.size());
}

double volume(const LatticeSoup& soup) {
  double six = 0;
  for (const auto& f : soup.faces)
    six += dot(soup.points[f[0]], cross(soup.points[f[1]], soup.points[f[2]]));
  return six / 6 / (kScale * kScale * kScale);
}

// Edges of one face or more than two, as places.
std::set<std::array<Vec3d, 2>> boundaryEdges(const LatticeSoup& soup) {
  std::set<std::array<Vec3d, 2>> boundary;
  for (const auto& [edge, count] : edgesOf(soup))
    if (count != 2) {
      const Vec3d &a = soup.points[edge.first], &b = soup.points[edge.second];
      boundary.insert({std::min(a, b), std::max(a, b)});
    }
  return boundary;
}

void expectPromises(const LatticeSoup& soup) {
  EXPECT_EQ(soup.inputs.size(), soup.faces.size());
  EXPECT_EQ(std::set<Vec3d>(soup.points.begin(), soup.points.end()).size(), soup.points.size());
  std::set<std::uint32_t> used;
  std::set<std::array<std::uint32_t, 4>> faces;
  for (std::size_t i = 0; i < soup.faces.size(); ++i) {
    auto f = soup.faces[i];
    used.insert(f.begin(), f.end());
    std::sort(f.begin(), f.end());
    EXPECT_TRUE(f[0] < f[1] && f[1] < f[2]);
    EXPECT_TRUE(faces.insert({f[0], f[1], f[2], soup.inputs[i]}).second);
  }
  EXPECT_EQ(used.size(), soup.points.size());
  for (const Vec3d& p : soup.points)
    EXPECT_EQ(roundToLattice(p), p);
}

struct Simplified {
  LatticeSoup soup;
  SimplifyCounts counts;
};

// Simplifies, and holds the result against the header.
Simplified simplified(const LatticeSoup& before, double radius) {
  Progress progress;
  const Envelope envelope(before.points, before.faces, radius * kScale * 1.5);
  Simplified after{before, {}};
  after.counts = simplifySoup(after.soup, envelope, radius * kScale, {}, progress);
  expectPromises(after.soup);
  EXPECT_EQ(after.soup.faces.size(), before.faces.size() - 2 * after.counts.collapses);
  EXPECT_EQ(eulerCharacteristic(after.soup), eulerCharacteristic(before));
  EXPECT_EQ(boundaryEdges(after.soup), boundaryEdges(before));
  EXPECT_LE(farthest(after.soup, before, 5), radius * kScale * (1 + 1e-9));
  // Points and middles of edges are held exactly, what is between them nearly so.
  for (const Vec3d& p : before.points)
    EXPECT_LE(distanceTo(after.soup, p), radius * kScale * (1 + 1e-9));
  EXPECT_LE(farthest(before, after.soup, 3), radius * kScale * 1.5);
  return after;
}

TEST(SimplifySoup, Sphere) {
  const LatticeSoup before = soupOf(meshes::sphere({0, 0, 0}, 1, 10));
  const Simplified after = simplified(before, 0.02);
  EXPECT_LT(after.soup.faces.size(), before.faces.size() / 2);
  EXPECT_NEAR(volume(after.soup), volume(before), 0.06);
  const Simplified finer = simplified(before, 0.002);
  EXPECT_GT(finer.soup.faces.size(), after.soup.faces.size());
}

TEST(SimplifySoup, TorusKeepsItsHole) {
  const LatticeSoup before = soupOf(meshes::torus(1, 0.4, 32, 16));
  EXPECT_EQ(eulerCharacteristic(before), 0);
  const Simplified after = simplified(before, 0.02);
  EXPECT_LT(after.soup.faces.size(), before.faces.size() / 2);
  EXPECT_NEAR(volume(after.soup) / volume(before), 1, 0.02);
}

TEST(SimplifySoup, BoxKeepsItsEdges) {
  const LatticeSoup before = soupOf(meshes::box({0, 0, 0}, {1, 1, 1}, 8));
  const Simplified after = simplified(before, 1e-3);
  EXPECT_LT(after.soup.faces.size(), 120u);
  EXPECT_NEAR(volume(after.soup), 1, 6e-3);
  EXPECT_LT(simplified(before, 1e-7).soup.faces.size(), 150u);
}

TEST(SimplifySoup, BoundaryOfASheetStays) {
  const LatticeSoup before = soupOf(meshes::sheet(16));
  const Simplified after = simplified(before, 1e-3);
  EXPECT_LT(after.soup.faces.size(), 200u); // 64 points of the boundary: 62 faces at least
  for (std::size_t f = 0; f < after.soup.faces.size(); ++f) {
    const auto& face = after.soup.faces[f];
    const Vec3d normal = cross(minus(after.soup.points[face[1]], after.soup.points[face[0]]),
                               minus(after.soup.points[face[2]], after.soup.points[face[0]]));
    EXPECT_GT(normal[2], 0) << f;
  }
}

TEST(SimplifySoup, ThinSpikesAreNotWornAway) {
  // A cone a hundred times as high as it is wide: no place on it is far from its axis.
  TriangleMesh mesh = meshes::box({-1, -1, -0.2}, {1, 1, 0}, 5);
  TriangleMesh cone;
  constexpr int kRings = 24, kAround = 6;
  for (int ring = 0; ring < kRings; ++ring)
    for (int i = 0; i < kAround; ++i) {
      const double r = 0.01 * (1 - double(ring) / kRings);
      cone.points.push_back({r * std::cos(2 * kPi * i / kAround),
                             r * std::sin(2 * kPi * i / kAround), double(ring) / kRings});
    }
  cone.points.push_back({0, 0, 1});
  cone.points.push_back({0, 0, 0});
  const auto number = [](int ring, int i) {
    return static_cast<std::uint32_t>(ring == kRings ? kRings * kAround
                                                     : ring * kAround + i % kAround);
  };
  for (int ring = 0; ring < kRings; ++ring)
    for (int i = 0; i < kAround; ++i) {
      meshes::addTriangle(cone, number(ring, i), number(ring, i + 1), number(ring + 1, i));
      if (ring + 1 < kRings)
        meshes::addTriangle(cone, number(ring, i + 1), number(ring + 1, i + 1),
                            number(ring + 1, i));
      else
        meshes::addTriangle(cone, number(0, i + 1), number(0, i), kRings * kAround + 1);
    }
  meshes::append(mesh, cone);
  const Simplified after = simplified(soupOf(mesh), 0.02);
  double highest = 0;
  for (const Vec3d& p : after.soup.points)
    highest = std::max(highest, p[2] / kScale);
  EXPECT_GE(highest, 0.98);
  EXPECT_GT(after.counts.collapses, 100u);
}

TEST(SimplifySoup, FinsAndContactsOfInputsStay) {
  LatticeSoup soup = soupOf(meshes::box({0, 0, 0}, {1, 1, 1}, 8));
  // A fin that stands on an edge of the lid, so that the edge has three faces.
  std::array<std::uint32_t, 2> ends{};
  for (std::uint32_t v = 0; v < soup.points.size(); ++v)
    for (std::size_t k = 0; k < 2; ++k)
      if (soup.points[v] == (Vec3d{kScale * 0.5, kScale * (0.5 + 0.125 * double(k)), kScale}))
        ends[k] = v;
  ASSERT_NE(ends[0], ends[1]);
  soup.points.push_back({kScale * 0.5, kScale * 0.5625, kScale * 1.5});
  const auto tip = static_cast<std::uint32_t>(soup.points.size() - 1);
  soup.faces.push_back({ends[0], ends[1], tip});
  soup.inputs.push_back(0);
  // Another input over two of the box's faces, reversed: these and their points are shared.
  for (const std::size_t f : {std::size_t(40), std::size_t(41)}) {
    const auto face = soup.faces[f];
    soup.faces.push_back({face[0], face[2], face[1]});
    soup.inputs.push_back(1);
  }
  const auto others = soup.faces;
  const Simplified after = simplified(soup, 1e-3);
  EXPECT_GT(after.counts.collapses, 100u);
  std::set<Vec3d> places(after.soup.points.begin(), after.soup.points.end());
  for (const std::uint32_t v : {ends[0], ends[1], tip, others[40][0], others[40][1], others[40][2],
                                others[41][0], others[41][1], others[41][2]})
    EXPECT_EQ(places.count(soup.points[v]), 1u) << v;
  EXPECT_EQ(std::count(after.soup.inputs.begin(), after.soup.inputs.end(), 1), 2);
  EXPECT_TRUE(std::is_sorted(after.soup.inputs.begin(), after.soup.inputs.end()));
}

TEST(SimplifySoup, DegenerateFacesAndSmallSolids) {
  // A point on an edge: a collinear face fills the slit.
  TriangleMesh slit = meshes::sheet(6);
  const auto midpoint = static_cast<std::uint32_t>(slit.points.size());
  const std::uint32_t a = slit.triangles[3 * 30], b = slit.triangles[3 * 30 + 1];
  slit.points.push_back(times(plus(slit.points[a], slit.points[b]), 0.5));
  const std::uint32_t c = slit.triangles[3 * 30 + 2];
  slit.triangles[3 * 30 + 1] = midpoint;
  meshes::addTriangle(slit, midpoint, b, c);
  meshes::addTriangle(slit, a, b, midpoint);
  simplified(soupOf(slit), 0.01);
  // Solids smaller than the radius keep four points at least.
  const TriangleMesh small = meshes::sphere({0, 0, 0}, 1e-3, 5);
  const Simplified after = simplified(soupOf(small), 0.01);
  EXPECT_GE(after.soup.faces.size(), 4u);
  LatticeSoup none;
  Progress progress;
  const Envelope envelope({}, {}, 1);
  EXPECT_EQ(simplifySoup(none, envelope, 1, {}, progress).collapses, 0u);
}

TEST(SimplifySoup, FixedPointsStay) {
  const LatticeSoup before = soupOf(meshes::sphere({0, 0, 0}, 1, 20));
  const Envelope envelope(before.points, before.faces, 0.02 * kScale);
  std::vector<std::uint8_t> fixed;
  std::size_t count = 0;
  for (const Vec3d& p : before.points) {
    fixed.push_back(p[0] > 0.5 * kScale);
    count += fixed.back();
  }
  Progress progress;
  LatticeSoup after = before;
  simplifySoup(after, envelope, 0.02 * kScale, fixed, progress);
  expectPromises(after);
  const std::set<Vec3d> left(after.points.begin(), after.points.end());
  for (std::size_t v = 0; v < fixed.size(); ++v)
    EXPECT_TRUE(!fixed[v] || left.count(before.points[v]) == 1) << v;
  // The others do not.
  EXPECT_GT(count, 100u);
  EXPECT_LT(after.points.size() - count, (before.points.size() - count) / 2);
}

// Enough points for many parts, whose borders have to move.
TEST(SimplifySoup, TheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = meshes::moved(meshes::sphere({0, 0, 0}, 1, 40), [](const Vec3d& p) {
    return times(p, 1 + 0.05 * std::sin(9 * p[0]) * std::sin(8 * p[1]));
  });
  const LatticeSoup before = soupOf(mesh);
  const Envelope envelope(before.points, before.faces, 0.01 * kScale);
  LatticeSoup first;
  for (const std::size_t threads : {1u, 2u, 8u}) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Progress progress;
    LatticeSoup after = before;
    simplifySoup(after, envelope, 0.005 * kScale, {}, progress);
    expectPromises(after);
    EXPECT_EQ(eulerCharacteristic(after), 2);
    EXPECT_LT(after.faces.size(), before.faces.size() / 5);
    if (first.faces.empty())
      first = after;
    EXPECT_EQ(after.points, first.points);
    EXPECT_EQ(after.faces, first.faces);
    EXPECT_EQ(after.inputs, first.inputs);
  }
}

TEST(SimplifySoup, StopsWhenCancelled) {
  LatticeSoup soup = soupOf(meshes::sphere({0, 0, 0}, 1, 20));
  const LatticeSoup before = soup;
  const Envelope envelope(soup.points, soup.faces, 0.01 * kScale);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(simplifySoup(soup, envelope, 0.005 * kScale, {}, progress), Error);
  EXPECT_EQ(soup.points, before.points);
  EXPECT_EQ(soup.faces, before.faces);
}

} // namespace
} // namespace tetvdb
