// SPDX-License-Identifier: Apache-2.0
#include "tetrahedralize/SoupMeshes.h"
#include "tetvdb/tetrahedralize/complex/Improve.h"
#include "tetvdb/tetrahedralize/insertion/InsertSoup.h"
#include "tetvdb/tetrahedralize/soup/Envelope.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <set>

namespace tetvdb {
namespace {

// Lattice units: 2e-4 of a unit of the meshes. As in the mesher, soups' grain is small against the
// tolerance, kReach / 1e4.
constexpr double kReach = 0x1p24;
constexpr std::uint32_t kFirst = 8;

struct Inserted {
  LatticeSoup soup;
  std::size_t inputs = 1;
  double reach = kReach;
  TetComplex complex;
  std::vector<std::uint32_t> missing;
};

using Coarsen = std::function<void(const LatticeSoup&, TetComplex&)>;

Inserted inserted(const std::vector<TriangleMesh>& meshes, double spacing = 0.25,
                  double reach = kReach, const Coarsen& coarsen = {}) {
  Inserted made;
  made.soup = soupOf(meshes);
  made.inputs = meshes.size();
  made.reach = reach;
  // What is missing goes first in another try, as run() suggests and the mesher does.
  std::vector<std::uint32_t> first;
  for (int attempt = 0; attempt < 4; ++attempt) {
    made.complex = complexOf(made.soup, spacing * kSoupScale);
    const Int128 volume = volumeOf(made.complex);
    SoupInsertion insertion(made.soup, made.inputs, kFirst, reach, [&](TetComplex& complex) {
      if (coarsen)
        coarsen(made.soup, complex);
    });
    Progress progress;
    insertion.run(made.complex, first, progress);
    made.missing = insertion.missing();
    EXPECT_NO_THROW(made.complex.verify());
    EXPECT_TRUE(volumeOf(made.complex) == volume);
    if (made.missing.empty())
      break;
    first.insert(first.end(), made.missing.begin(), made.missing.end());
  }
  return made;
}

std::array<Vec3d, 3> cornersOf(const std::vector<Vec3d>& points,
                               const std::array<std::uint32_t, 3>& face) {
  return {points[face[0]], points[face[1]], points[face[2]]};
}

Vec3d within(const std::array<Vec3d, 3>& f, double s, double t) {
  return plus(f[0], plus(times(minus(f[1], f[0]), s), times(minus(f[2], f[0]), t)));
}

// All triangles are in, their faces near them, and they near their faces.
void expectNear(const Inserted& made) {
  EXPECT_EQ(made.missing.size(), 0u);
  const TrackedFaces surface = trackedFaces(made.complex);
  FaceDistances toSoup, toFaces;
  for (const auto& face : made.soup.faces)
    toSoup.add(cornersOf(made.soup.points, face));
  for (const auto& face : surface.faces)
    toFaces.add(cornersOf(surface.points, face));
  double out = 0, in = 0;
  std::set<std::uint32_t> corners;
  for (const auto& face : surface.faces) {
    corners.insert(face.begin(), face.end());
    out = std::max(out, toSoup(within(cornersOf(surface.points, face), 1 / 3.0, 1 / 3.0)));
  }
  for (const std::uint32_t p : corners)
    out = std::max(out, toSoup(surface.points[p]));
  for (const auto& face : made.soup.faces)
    for (const auto& [s, t] : {std::pair{1 / 3.0, 1 / 3.0}, std::pair{0.5, 0.0}, {0.1, 0.7}})
      in = std::max(in, toFaces(within(cornersOf(made.soup.points, face), s, t)));
  EXPECT_LE(out, made.reach);
  EXPECT_LE(in, made.reach);
}

// Of an input: closed edge by edge, and the volume that the soup's faces
// enclose, with signs.
void expectSolid(const Inserted& made) {
  const TrackedFaces surface = trackedFaces(made.complex);
  expectClosed(surface, true);
  for (std::size_t input = 0; input < made.inputs; ++input) {
    double area = 0;
    Int128 expected = 0, actual = 0;
    for (std::size_t f = 0; f < made.soup.faces.size(); ++f) {
      if (!made.soup.inputs.empty() && made.soup.inputs[f] != input)
        continue;
      const auto face = cornersOf(made.soup.points, made.soup.faces[f]);
      expected += sixfoldVolume(face);
      area += length(cross(minus(face[1], face[0]), minus(face[2], face[0]))) / 2;
    }
    for (std::size_t f = 0; f < surface.faces.size(); ++f)
      actual += digitOf(surface.chains[f], input, made.inputs) *
                sixfoldVolume(cornersOf(surface.points, surface.faces[f]));
    EXPECT_LE(std::abs(static_cast<double>(actual - expected)), 6 * area * made.reach);
    EXPECT_GT(static_cast<double>(actual), 6 * area * made.reach) << "encloses nothing to speak of";
  }
}

// In tets away from the soup: summed along faces from the box's side, against
// solid angles.
void expectWinding(const Inserted& made, const std::vector<TriangleMesh>& meshes) {
  const auto& tets = made.complex.tets;
  std::vector<Chain> winding(tets.size(), 0);
  std::vector<char> known(tets.size(), 0);
  std::vector<std::uint32_t> ahead;
  for (std::uint32_t t = 0; t < tets.size(); ++t)
    for (const std::uint32_t next : tets[t].neighbours)
      if (next == TetComplex::kOutside && known[t] == 0) {
        known[t] = 1;
        ahead.push_back(t);
      }
  while (!ahead.empty()) {
    const std::uint32_t t = ahead.back();
    ahead.pop_back();
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      const std::uint32_t next = tets[t].neighbours[localFace];
      if (next == TetComplex::kOutside)
        continue;
      const Chain there = winding[t] - tets[t].chains[localFace];
      if (known[next] == 0) {
        known[next] = 1;
        winding[next] = there;
        ahead.push_back(next);
      }
      ASSERT_EQ(winding[next], there);
    }
  }
  FaceDistances toSoup;
  for (const auto& face : made.soup.faces)
    toSoup.add(cornersOf(made.soup.points, face));
  std::size_t judged = 0;
  for (std::size_t t = 0; t < tets.size(); t += 1 + tets.size() / 400) {
    Vec3d centre{0, 0, 0};
    for (const std::uint32_t corner : tets[t].corners)
      centre = plus(centre, times(made.complex.at(corner), 0.25));
    if (toSoup(centre) < made.reach)
      continue;
    ++judged;
    for (std::size_t input = 0; input < made.inputs; ++input)
      EXPECT_NEAR(digitOf(winding[t], input, made.inputs),
                  meshes::windingNumberAt(meshes[input], times(centre, 1 / kSoupScale)), 1e-3);
  }
  EXPECT_GT(judged, 50u);
}

void expectAllOf(const std::vector<TriangleMesh>& meshes, double spacing = 0.25,
                 double reach = kReach) {
  const Inserted made = inserted(meshes, spacing, reach);
  expectNear(made);
  expectSolid(made);
  expectWinding(made, meshes);
}

// So that nothing is aligned with axes.
TriangleMesh turned(const TriangleMesh& mesh, const Vec3d& offset = {0, 0, 0}) {
  return meshes::moved(mesh, [&](const Vec3d& p) {
    const double c = std::cos(0.7), s = std::sin(0.7);
    const Vec3d q{c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
    return plus({q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]}, offset);
  });
}

// Each face in three, from a point so near to one of its edges.
TriangleMesh withCaps(const TriangleMesh& mesh, double share) {
  TriangleMesh capped;
  capped.points = mesh.points;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const std::uint32_t a = mesh.triangles[i], b = mesh.triangles[i + 1], c = mesh.triangles[i + 2];
    const auto n = static_cast<std::uint32_t>(capped.points.size());
    const std::array<Vec3d, 3> f{mesh.points[a], mesh.points[b], mesh.points[c]};
    capped.points.push_back(within(f, 0.4, share));
    meshes::addTriangle(capped, a, b, n);
    meshes::addTriangle(capped, b, c, n);
    meshes::addTriangle(capped, c, a, n);
  }
  return capped;
}

TriangleMesh randomTets(int count, std::uint64_t seed) {
  meshes::Random random(seed);
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    TriangleMesh tet;
    for (int k = 0; k < 4; ++k)
      tet.points.push_back({random.unit(), random.unit(), random.unit()});
    tet.triangles = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    meshes::append(mesh, meshes::signedVolume(tet) > 0 ? tet : meshes::flipped(tet));
  }
  return mesh;
}

TEST(SoupInsertion, CleanSolids) {
  expectAllOf({meshes::box()});
  expectAllOf({meshes::sphere({0, 0, 0}, 1, 10)});
  expectAllOf({meshes::torus()});
  expectAllOf({turned(meshes::box({0, 0, 0}, {1, 2, 0.1}, 3))});
}

TEST(SoupInsertion, WithAReachOfAFewGrains) {
  expectAllOf({meshes::sphere({0, 0, 0}, 1, 6)}, 0.25, 64 * kSoupGrain);
  expectAllOf({turned(meshes::box({0, 0, 0}, {1, 1, 1}, 2))}, 0.25, 64 * kSoupGrain);
}

TEST(SoupInsertion, OverlappingSolids) {
  expectAllOf(
      {meshes::joined({meshes::sphere({0, 0, 0}, 1, 8), meshes::sphere({0.7, 0.3, 0.2}, 0.9, 8)})});
  expectAllOf({meshes::joined({meshes::box({0, 0, 0}, {1, 1, 1}, 2),
                               turned(meshes::box({0, 0, 0}, {1, 1, 1}, 2), {0.3, 0.4, 0.2})})});
  expectAllOf({meshes::joined({meshes::torus(), turned(meshes::torus(), {0.4, 0.2, 0})})});
}

TEST(SoupInsertion, CoplanarFacesThatOverlap) {
  // Two faces of each in the same planes, looking the same way.
  const TriangleMesh mesh = meshes::joined(
      {meshes::box({0, 0, 0}, {1, 1, 1}, 2), meshes::box({0.31, 0.17, 0}, {1.31, 1.17, 1}, 3)});
  expectAllOf({mesh});
  expectAllOf({turned(mesh)}, 0.25, kReach);
  // Nearly coplanar.
  expectAllOf({meshes::joined({meshes::box({0, 0, 0}, {1, 1, 1}, 2),
                               meshes::box({0.31, 0.17, 1e-9}, {1.31, 1.17, 1 + 1e-9}, 3)})});
}

TEST(SoupInsertion, SolidsThatTouch) {
  const TriangleMesh mesh = meshes::box({0, 0, 0}, {1, 1, 1}, 2);
  for (const Vec3d& offset : {Vec3d{1, 0, 0}, Vec3d{1, 0.3, 0.2}, Vec3d{1, 1, 0}, Vec3d{1, 1, 1}}) {
    const auto other = meshes::moved(mesh, [&](const Vec3d& p) { return plus(p, offset); });
    expectAllOf({meshes::joined({mesh, other})});
    expectAllOf({turned(meshes::joined({mesh, other}))}, 0.25, kReach);
  }
}

TEST(SoupInsertion, InputsThatShareFaces) {
  const TriangleMesh mesh = meshes::sphere({0, 0, 0}, 1, 6);
  expectAllOf({mesh, mesh});
  expectAllOf({mesh, meshes::sphere({0.5, 0, 0}, 1, 6), turned(meshes::box(), {0.2, 0, 0})});
  // A wall between two materials.
  expectAllOf({meshes::box({0, 0, 0}, {1, 1, 1}, 3), meshes::box({1, 0, 0}, {2, 1, 1}, 3)});
}

TEST(SoupInsertion, NeedlesAndCaps) {
  for (const double share : {1e-3, 1e-8, 1e-9}) {
    expectAllOf({withCaps(meshes::box({0, 0, 0}, {1, 1, 1}, 2), share)});
    expectAllOf({withCaps(turned(meshes::sphere({0, 0, 0}, 1, 4)), share)}, 0.25, kReach);
  }
  // Needles a thousandth and less as wide as long. (Below three tolerances, 7e-6 here, their sides
  // are as good as collinear and have no faces of their own.)
  for (const double width : {1e-3, 1e-5})
    expectAllOf({meshes::joined(
        {meshes::box(), turned(meshes::box({0, 0, 0}, {width, width, 1}), {0.5, 0.5, 0.5})})});
}

TEST(SoupInsertion, FansOfTwoHundredTriangles) {
  const Inserted made = inserted({meshes::cylinder(1, 1, 200)});
  EXPECT_EQ(made.missing.size(), 0u);
  expectSolid(made);
}

// Strips as long as the tubes are, four hundred times their width, that cut one another: what each
// leaves in the others' way is cleared in between.
TEST(SoupInsertion, LongThinTrianglesThroughOneAnother) {
  const TriangleMesh tube = meshes::cylinder(0.05, 1, 120);
  const std::vector<TriangleMesh> tubes = {
      meshes::joined({tube, turned(tube, {0.1, 0.2, 0.3}), turned(turned(tube), {0.3, 0.1, 0})})};
  std::size_t before = 0, after = 0, calls = 0;
  const Inserted made =
      inserted(tubes, 0.25, kReach, [&](const LatticeSoup& soup, TetComplex& complex) {
        const auto isFixed = [&] {
          std::vector<bool> fixed;
          for (const TetComplex::Point& point : complex.points)
            fixed.push_back(point.fixed);
          return fixed;
        };
        const std::vector<bool> held = isFixed();
        before += complex.tetCount();
        Progress progress;
        const Envelope surface(soup.points, soup.faces, kReach), boundary({}, {}, kReach);
        coarsen(complex, {surface, boundary, kReach}, progress);
        after += complex.tetCount();
        ++calls;
        EXPECT_TRUE(isFixed() == held);
      });
  EXPECT_GT(calls, 0u);
  EXPECT_LT(2 * after, before);
  EXPECT_EQ(made.missing.size(), 0u);
  expectSolid(made);
  expectWinding(made, tubes);
  // What was held is free again, but for the box.
  for (const TetComplex::Tet& tet : made.complex.tets)
    for (unsigned localFace = 0; tet.exists() && localFace < 4; ++localFace)
      for (const unsigned corner : kFaceCorners[localFace]) {
        EXPECT_FALSE(tet.tracked[localFace] && made.complex.points[tet.corners[corner]].fixed);
      }
}

TEST(SoupInsertion, OneHugeTriangleUnderThousandsOfSmallOnes) {
  // The small box stands on the plate's one top face, coplanar with it.
  const Inserted made =
      inserted({meshes::joined({meshes::box({-2, -2, -0.2}, {3, 3, 0}),
                                meshes::box({0.3, 0.2, 0}, {0.45, 0.35, 0.1}, 16)})});
  EXPECT_EQ(made.missing.size(), 0u);
  expectSolid(made);
}

TEST(SoupInsertion, RandomTetsThroughOneAnother) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    expectAllOf({randomTets(5, seed)});
}

// What an open soup leaves open is marked, and lies along its open edges.
TEST(SoupInsertion, OpenEdgesAreMarked) {
  const std::vector<TriangleMesh> soups = {
      meshes::sheet(4), turned(meshes::sheet(4)), meshes::moebius(),
      meshes::cylinder(1, 1, 32, false),
      meshes::without(meshes::sphere({0, 0, 0}, 1, 8), [](std::size_t f) { return f < 80; }),
      // Across one another.
      meshes::joined({meshes::sheet(3, 0.5), turned(meshes::sheet(3, 0.2))})};
  for (const TriangleMesh& mesh : soups) {
    const Inserted made = inserted({mesh});
    expectNear(made);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& face : made.soup.faces)
      for (std::size_t i = 0; i < 3; ++i)
        ++edges[std::minmax(face[i], face[(i + 1) % 3])];
    FaceDistances toBoundary;
    std::size_t open = 0;
    for (const auto& [edge, faces] : edges)
      if (faces == 1) {
        const Vec3d &a = made.soup.points[edge.first], &b = made.soup.points[edge.second];
        toBoundary.add({a, b, b});
        ++open;
        EXPECT_TRUE(made.complex.points[edge.first + kFirst].onBoundary);
        EXPECT_TRUE(made.complex.points[edge.second + kFirst].onBoundary);
      }
    EXPECT_GT(open, 10u);
    double farthest = 0;
    for (const auto& point : made.complex.points)
      if (point.onBoundary)
        farthest = std::max(farthest, toBoundary(point.at));
    EXPECT_LE(farthest, made.reach);
    // Where the chain ends, there is a boundary. (A strip that cannot be oriented
    // ends also within.)
    const TrackedFaces surface = trackedFaces(made.complex);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sums;
    for (const auto& face : surface.faces)
      for (std::size_t i = 0; i < 3; ++i)
        ++sums[std::minmax(face[i], face[(i + 1) % 3])];
    for (const auto& [edge, faces] : sums)
      if (faces == 1) {
        EXPECT_TRUE(made.complex.points[edge.first].onBoundary);
        EXPECT_TRUE(made.complex.points[edge.second].onBoundary);
      }
  }
  const Inserted closed = inserted({meshes::sphere()});
  for (const auto& point : closed.complex.points)
    EXPECT_FALSE(point.onBoundary);
}

TEST(SoupInsertion, TheSameMeshForAnyNumberOfThreads) {
  const std::vector<TriangleMesh> meshes = {
      meshes::joined({meshes::sphere({0, 0, 0}, 1, 20), meshes::sphere({0.7, 0.3, 0.2}, 0.9, 20)}),
      turned(meshes::box({0, 0, 0}, {1, 1, 1}, 4))};
  const auto bytes = [&](int threads) {
    return onThreads(threads, [&] { return bytesOf(inserted(meshes, 0.1).complex); });
  };
  const std::string once = bytes(1);
  for (const int threads : {1, 2, 8})
    EXPECT_TRUE(bytes(threads) == once) << threads;
}

TEST(SoupInsertion, StopsWhenCancelled) {
  const LatticeSoup soup = soupOf({meshes::sphere({0, 0, 0}, 1, 10)});
  TetComplex complex = complexOf(soup, 0.1 * kSoupScale);
  SoupInsertion insertion(soup, 1, kFirst, kReach, [](TetComplex&) {});
  Progress progress;
  progress.cancel();
  EXPECT_THROW(insertion.run(complex, {}, progress), Error);
}

} // namespace
} // namespace tetvdb
