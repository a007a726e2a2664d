// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <tuple>

namespace tetvdb {
namespace {

WorkingLattice latticeOf(const std::vector<TriangleMesh>& inputs) {
  Box box;
  for (const TriangleMesh& mesh : inputs)
    for (const Vec3d& p : mesh.points)
      box.add(p);
  return WorkingLattice(box);
}

LatticeSoup snapped(const std::vector<TriangleMesh>& inputs, double grain = 1) {
  Progress progress;
  return latticeSoup(inputs, latticeOf(inputs), grain, progress);
}

// What LatticeSoup.h promises of any soup.
void expectTidy(const LatticeSoup& soup) {
  std::set<Vec3d> points(soup.points.begin(), soup.points.end());
  EXPECT_EQ(points.size(), soup.points.size());
  std::vector<char> used(soup.points.size(), 0);
  std::set<std::tuple<std::uint16_t, std::array<std::uint32_t, 3>>> faces;
  EXPECT_TRUE(soup.inputs.empty() || soup.inputs.size() == soup.faces.size());
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    auto face = soup.faces[f];
    for (const std::uint32_t corner : face) {
      ASSERT_LT(corner, used.size());
      used[corner] = 1;
    }
    std::sort(face.begin(), face.end());
    EXPECT_TRUE(face[0] != face[1] && face[1] != face[2]);
    EXPECT_TRUE(
        faces.insert({soup.inputs.empty() ? std::uint16_t(0) : soup.inputs[f], face}).second);
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);
}

double volumeOf(const LatticeSoup& soup, double unit) {
  TriangleMesh mesh;
  for (const Vec3d& p : soup.points)
    mesh.points.push_back(times(p, unit));
  for (const auto& f : soup.faces)
    meshes::addTriangle(mesh, f[0], f[1], f[2]);
  return meshes::signedVolume(mesh);
}

TEST(LatticeSoup, KeepsACleanMeshInItsOrder) {
  const TriangleMesh mesh = meshes::sphere({1, 2, 3}, 2, 6);
  const LatticeSoup soup = snapped({mesh});
  expectTidy(soup);
  ASSERT_EQ(soup.faces.size(), mesh.triangleCount());
  ASSERT_EQ(soup.points.size(), mesh.points.size());
  const WorkingLattice lattice = latticeOf({mesh});
  for (std::size_t f = 0; f < soup.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d offset = minus(lattice.toWorld(soup.points[soup.faces[f][k]]),
                                 mesh.points[mesh.triangles[3 * f + k]]);
      EXPECT_LE(length(offset), lattice.unit());
    }
}

TEST(LatticeSoup, WeldsASoupOfTriangles) {
  const TriangleMesh mesh = meshes::torus();
  const LatticeSoup soup = snapped({meshes::unwelded(mesh)});
  expectTidy(soup);
  EXPECT_EQ(soup.points.size(), mesh.points.size());
  EXPECT_EQ(soup.faces.size(), mesh.triangleCount());
}

TEST(LatticeSoup, PutsPointsOnTheGrain) {
  const TriangleMesh mesh = meshes::sphere({0, 0, 0}, 1, 8);
  const WorkingLattice lattice = latticeOf({mesh});
  for (const double grain : {1.0, 2.0, 1024.0, 0x1p40}) {
    const LatticeSoup soup = snapped({mesh}, grain);
    expectTidy(soup);
    for (const Vec3d& p : soup.points)
      for (const double coordinate : p)
        EXPECT_EQ(std::fmod(coordinate, grain), 0);
    // A coarse grain merges points, and the surface stays closed: its volume is
    // a sphere's, more or less.
    EXPECT_NEAR(volumeOf(soup, lattice.unit()) / meshes::signedVolume(mesh), 1,
                20 * grain * lattice.unit());
  }
  EXPECT_LT(snapped({meshes::sphere({0, 0, 0}, 1, 60)}, 0x1p42).points.size(), 6000u);
}

TEST(LatticeSoup, OfFacesOverTheSamePointsTheSurplusDecides) {
  // A sheet as often each way as said, and what is left of it.
  for (int up = 0; up < 4; ++up)
    for (int down = 0; down < 4; ++down) {
      TriangleMesh mesh;
      for (int i = 0; i < up; ++i)
        meshes::append(mesh, meshes::sheet(2));
      for (int i = 0; i < down; ++i)
        meshes::append(mesh, meshes::flipped(meshes::sheet(2)));
      meshes::append(mesh, meshes::sheet(2, 1)); // so that there is a box
      const LatticeSoup soup = snapped({mesh});
      expectTidy(soup);
      std::size_t ups = 0, downs = 0;
      for (const auto& f : soup.faces) {
        const Vec3d normal = cross(minus(soup.points[f[1]], soup.points[f[0]]),
                                   minus(soup.points[f[2]], soup.points[f[0]]));
        (normal[2] > 0 ? ups : downs) += 1;
      }
      EXPECT_EQ(ups, 8u + (up > down ? 8u : 0u)) << up << ' ' << down;
      EXPECT_EQ(downs, down > up ? 8u : 0u) << up << ' ' << down;
    }
}

TEST(LatticeSoup, FacesOfSeveralInputsStaySide) {
  const TriangleMesh mesh = meshes::box();
  const LatticeSoup soup = snapped({mesh, meshes::flipped(mesh), mesh});
  expectTidy(soup);
  EXPECT_EQ(soup.points.size(), 8u);
  ASSERT_EQ(soup.faces.size(), 36u);
  ASSERT_EQ(soup.inputs.size(), 36u);
  for (std::size_t f = 0; f < 36; ++f)
    EXPECT_EQ(soup.inputs[f], f / 12);
}

TEST(LatticeSoup, DropsWhatHasNoArea) {
  TriangleMesh mesh = meshes::box();
  const auto n = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.push_back({0.25, 0, 0});  // collinear with an edge: stays
  mesh.points.push_back({1e-14, 0, 0}); // becomes corner 0
  mesh.points.push_back({5, 5, 5});     // of no face
  std::uint32_t corner = 0, other = 0;
  for (std::uint32_t p = 0; p < n; ++p) {
    if (mesh.points[p] == Vec3d{0, 0, 0})
      corner = p;
    if (mesh.points[p] == Vec3d{1, 0, 0})
      other = p;
  }
  meshes::addTriangle(mesh, corner, other, corner);
  meshes::addTriangle(mesh, corner, n + 1, other);
  meshes::addTriangle(mesh, corner, n, other);
  const LatticeSoup soup = snapped({mesh});
  expectTidy(soup);
  EXPECT_EQ(soup.faces.size(), 13u);
  EXPECT_EQ(soup.points.size(), 9u);
}

TEST(LatticeSoup, TidyingMovedPointsMergesThem) {
  Progress progress;
  LatticeSoup soup = snapped({meshes::sphere({0, 0, 0}, 1, 8)});
  // An edge becomes a point: two faces go.
  const auto edge = soup.faces[100];
  soup.points[edge[0]] = soup.points[edge[1]];
  const std::size_t points = soup.points.size(), faces = soup.faces.size();
  tidySoup(soup, progress);
  expectTidy(soup);
  EXPECT_EQ(soup.points.size(), points - 1);
  EXPECT_EQ(soup.faces.size(), faces - 2);
  // A whole soup that falls flat onto its mirror image is gone.
  LatticeSoup flat = snapped({meshes::sphere({0, 0, 0}, 1, 8)});
  for (Vec3d& p : flat.points)
    p[2] = 0;
  tidySoup(flat, progress);
  expectTidy(flat);
  EXPECT_TRUE(flat.faces.empty());
  tidySoup(flat, progress);
  EXPECT_TRUE(flat.points.empty());
}

TEST(LatticeSoup, FarFromTheOriginSnapsToWhatDoublesTellApart) {
  const Vec3d far{1e8, -1e8, 1e8};
  const TriangleMesh mesh =
      meshes::moved(meshes::sphere({0, 0, 0}, 1, 6), [&](const Vec3d& p) { return plus(p, far); });
  const WorkingLattice lattice = latticeOf({mesh});
  const LatticeSoup soup = snapped({mesh});
  expectTidy(soup);
  ASSERT_EQ(soup.points.size(), mesh.points.size());
  for (const Vec3d& p : soup.points) {
    const Vec3d offset = minus(lattice.toWorld(p), far);
    EXPECT_NEAR(length(offset), 1, 1e-6);
  }
}

} // namespace
} // namespace tetvdb
