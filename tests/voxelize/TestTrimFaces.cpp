// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "fields/UnionBoundary.h"
#include "tetvdb/fields/DistanceBand.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/SoupChain.h"
#include "tetvdb/voxelize/TrimFaces.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

struct Surface {
  openvdb::FloatGrid::Ptr grid;
  openvdb::BoolGrid::Ptr mask;
  TrimCounts counts;
  Report report;
};

template <typename... Input>
Surface surfaceOf(double voxel, double halfWidth, const Input&... input) {
  VoxelizeOptions options;
  options.voxelSize = {voxel, voxel, voxel};
  options.grids = {GridKind::Mask};
  ShapeOptions shapes;
  shapes.grids = {GridKind::Surface};
  shapes.halfWidth = halfWidth;
  Surface surface;
  Progress progress;
  Voxelization made = voxelize(input..., options, surface.report, progress);
  surface.counts = addShapeGrids(input..., shapes, made, surface.report, progress).trim;
  surface.mask = openvdb::gridPtrCast<openvdb::BoolGrid>(made.volume.grids().all.front());
  surface.grid = openvdb::gridPtrCast<openvdb::FloatGrid>(made.volume.grids().all.back());
  return surface;
}

// All voxels of the narrow band, and two around it: absolute values are `distance`, up to
// `tolerance` voxels.
void expectMagnitudes(const Surface& surface, double voxel, double tolerance,
                      const std::function<double(const Vec3d&, double)>& distance) {
  const auto values = surface.grid->getConstAccessor();
  const auto inside = surface.mask->getConstAccessor();
  const double band = surface.grid->background();
  openvdb::CoordBBox box = surface.grid->evalActiveVoxelBoundingBox();
  box.expand(2);
  int wrong = 0;
  for (auto at = box.begin(); at; ++at) {
    const Vec3d p{(*at).x() * voxel, (*at).y() * voxel, (*at).z() * voxel};
    const double value = values.getValue(*at), expected = std::min(distance(p, band), band);
    const bool right = (value < 0) == inside.isValueOn(*at) &&
                       std::abs(std::abs(value) - expected) <= tolerance * voxel;
    if (!right && ++wrong < 5)
      ADD_FAILURE() << *at << ": " << value << ", expected " << expected;
  }
  EXPECT_EQ(wrong, 0);
}

constexpr double kTolerance = kDistanceError + 1e-6; // and the floats' own rounding

// Distance to the boundary of bodies' union, up to the second argument.
std::function<double(const Vec3d&, double)> toUnion(const std::vector<oracle::Body>& bodies) {
  return [faces = oracle::PolygonDistance(oracle::boundaryOfUnion(bodies))](const Vec3d& p,
                                                                            double max) {
    return static_cast<double>(faces({p[0], p[1], p[2]}, max));
  };
}

oracle::Point pointOf(const Vec3d& p) {
  return {p[0], p[1], p[2]};
}

std::vector<oracle::Body> bodiesOf(const TetMesh& mesh) {
  std::vector<oracle::Body> bodies;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t)
    bodies.push_back(oracle::tetBody(
        {pointOf(mesh.points[mesh.tets[4 * t]]), pointOf(mesh.points[mesh.tets[4 * t + 1]]),
         pointOf(mesh.points[mesh.tets[4 * t + 2]]), pointOf(mesh.points[mesh.tets[4 * t + 3]])}));
  return bodies;
}

// The box of `low` and `high`, turned by `turn`.
oracle::Body boxBody(const Vec3d& low, const Vec3d& high,
                     const std::function<Vec3d(const Vec3d&)>& turn) {
  const auto corner = [&](int x, int y, int z) {
    return pointOf(turn({x ? high[0] : low[0], y ? high[1] : low[1], z ? high[2] : low[2]}));
  };
  oracle::Body body;
  body.add({corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0), corner(1, 0, 0)});
  body.add({corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)});
  body.add({corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)});
  body.add({corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0)});
  body.add({corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0)});
  body.add({corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1)});
  return body;
}

Vec3d turned(const Vec3d& p) {
  const double c = std::cos(0.37), s = std::sin(0.37);
  const Vec3d q{c * p[0] - s * p[1] + 0.01234, s * p[0] + c * p[1] - 0.04321, p[2] + 0.0031};
  return {q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]};
}
Vec3d turnedOtherwise(const Vec3d& p) {
  const double c = std::cos(1.1), s = std::sin(1.1);
  const Vec3d q{p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]};
  return turned({c * q[0] - s * q[1] + 0.31, s * q[0] + c * q[1] - 0.22, q[2] + 0.17});
}
Vec3d unturned(const Vec3d& p) {
  return p;
}

TEST(TrimFaces, CrossingBoxes) {
  const Vec3d low{0, 0, 0}, high{1, 1, 1}, thin{0.2, 0.3, -0.7}, thinHigh{0.6, 0.5, 1.9};
  TriangleMesh mesh = meshes::joined({meshes::moved(meshes::box(low, high, 3), turned),
                                      meshes::moved(meshes::box(thin, thinHigh, 2), turned),
                                      meshes::moved(meshes::box(low, high), turnedOtherwise)});
  const Surface surface = surfaceOf(0.043, 4, mesh, SolidOptions());
  EXPECT_GT(surface.counts.cut, 10u);
  expectMagnitudes(surface, 0.043, kTolerance,
                   toUnion({boxBody(low, high, turned), boxBody(thin, thinHigh, turned),
                            boxBody(low, high, turnedOtherwise)}));
}

TEST(TrimFaces, BoxesAlongTheAxesWithFacesInOnePlane) {
  // Side faces of both lie in one plane, for which the union's own faces are told by hand.
  const TriangleMesh mesh =
      meshes::joined({meshes::box({0, 0, 0}, {2, 1, 1}), meshes::box({1, 0, 0}, {3, 1, 1}, 2)});
  const Surface surface = surfaceOf(0.0625, 3, mesh, SolidOptions());
  EXPECT_GT(surface.counts.met, 0u);
  expectMagnitudes(surface, 0.0625, kTolerance, toUnion({boxBody({0, 0, 0}, {3, 1, 1}, unturned)}));
}

TEST(TrimFaces, TouchingBoxesOfOtherPoints) {
  const auto whole = toUnion({boxBody({0, 0, 0}, {2, 1, 1}, unturned)});
  for (const int n : {1, 3}) {
    const TriangleMesh mesh =
        meshes::joined({meshes::box({0, 0, 0}, {1, 1, 1}), meshes::box({1, 0, 0}, {2, 1, 1}, n)});
    const Surface surface = surfaceOf(0.07, 3, mesh, SolidOptions());
    EXPECT_EQ(surface.counts.removed, n == 1 ? 4u : 20u); // 2 + 2, or 2 + 18
    EXPECT_EQ(surface.counts.cut, 0u);
    expectMagnitudes(surface, 0.07, kTolerance, whole);
  }
  const TetMesh tets = meshes::joined(meshes::kuhnGrid(1, 1, 1),
                                      meshes::scaled(meshes::kuhnGrid(1, 1, 1), 1, {1, 0, 0}));
  expectMagnitudes(surfaceOf(0.07, 3, tets), 0.07, kTolerance, whole);
}

TEST(TrimFaces, SmallBoxOnALargeOne) {
  const TriangleMesh mesh = meshes::joined(
      {meshes::box({0, 0, 0}, {2, 2, 1}), meshes::box({0.5, 0.6, 1}, {1.1, 1.3, 1.8})});
  const Surface surface = surfaceOf(0.05, 3, mesh, SolidOptions());
  EXPECT_EQ(surface.counts.cut, 2u); // of the large one's upper side
  // What faces have in common with one plane is told apart by a hair.
  expectMagnitudes(surface, 0.05, kTolerance,
                   toUnion({boxBody({0, 0, 0}, {2, 2, 1}, unturned),
                            boxBody({0.5, 0.6, 1 - 1e-9}, {1.1, 1.3, 1.8}, unturned)}));
}

TEST(TrimFaces, NestedSolidsGoAndCavitiesStay) {
  const TriangleMesh outer = meshes::box({0, 0, 0}, {1, 1, 1}, 2);
  const TriangleMesh inner = meshes::box({0.3, 0.3, 0.3}, {0.6, 0.7, 0.7});
  const Surface filled = surfaceOf(0.05, 6, meshes::joined({outer, inner}), SolidOptions());
  EXPECT_EQ(filled.counts.removed, 12u);
  EXPECT_EQ(filled.counts.met, 0u);
  expectMagnitudes(filled, 0.05, kTolerance, toUnion({boxBody({0, 0, 0}, {1, 1, 1}, unturned)}));

  const Surface hollow =
      surfaceOf(0.05, 6, meshes::joined({outer, meshes::flipped(inner)}), SolidOptions());
  EXPECT_EQ(hollow.counts.removed, 0u);
  SolidOptions parity;
  parity.inside = InsideRule::Parity;
  EXPECT_EQ(surfaceOf(0.05, 6, meshes::joined({outer, inner}), parity).counts.removed, 0u);
}

TEST(TrimFaces, RandomTetsAgainstClipping) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const TetMesh tets = meshes::soup(9, 1.0, 1.2, seed);
    const Surface surface = surfaceOf(0.11, 3, tets);
    EXPECT_GT(surface.counts.cut, 0u);
    expectMagnitudes(surface, 0.11, kTolerance, toUnion(bodiesOf(tets)));
  }
}

TEST(TrimFaces, CrossingBalls) {
  const double radius = 1, apart = 1.1;
  const TriangleMesh mesh = meshes::joined(
      {meshes::sphere({0, 0, 0}, radius, 40), meshes::sphere({apart, 0.03, 0.02}, radius, 40)});
  const Surface surface = surfaceOf(0.04, 8, mesh, SolidOptions());
  EXPECT_GT(surface.counts.cut, 100u);
  // Nearest of a sphere's points that are not in the other ball: straight outward, or on the circle
  // in which the spheres meet.
  const double along = std::sqrt(apart * apart + 0.03 * 0.03 + 0.02 * 0.02);
  const Vec3d way{apart / along, 0.03 / along, 0.02 / along};
  const auto distance = [&](const Vec3d& p, double) {
    const double x = p[0] * way[0] + p[1] * way[1] + p[2] * way[2];
    const double r = std::sqrt(std::max(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - x * x, 0.0));
    const auto toSphere = [&](double from) { // centre at 0, the other one at `along`
      const double length = std::hypot(from, r);
      if (from / length * radius <= along / 2)
        return std::abs(length - radius);
      return std::hypot(from - along / 2, r - std::sqrt(radius * radius - along * along / 4));
    };
    return std::min(toSphere(x), toSphere(along - x));
  };
  expectMagnitudes(surface, 0.04, 0.1, distance); // the facets' arrow is 0.06 voxels
}

// A soup's solid by sampling: winding numbers are sums over tets of the sign of each, and points of
// faces are boundary where they differ in kind a hair to either side.
class SampledSolid {
public:
  SampledSolid(const TetMesh& tets, InsideRule rule, int steps) : rule_(rule) {
    for (std::size_t t = 0; t < tets.tetCount(); ++t) {
      std::array<oracle::Point, 4> c;
      for (std::size_t k = 0; k < 4; ++k)
        c[k] = pointOf(tets.points[tets.tets[4 * t + k]]);
      const long double volume =
          oracle::product(oracle::perpendicular(oracle::from(c[0], c[1]), oracle::from(c[0], c[2])),
                          oracle::from(c[0], c[3]));
      if (volume == 0)
        continue;
      bodies_.push_back(oracle::tetBody(c));
      signs_.push_back(volume > 0 ? 1 : -1);
    }
    long double longest = 0;
    for (const oracle::Body& body : bodies_)
      for (const oracle::Polygon& face : body.faces) {
        sample(face, steps);
        for (std::size_t k = 0; k < 3; ++k) {
          const oracle::Point edge = oracle::from(face[k], face[(k + 1) % 3]);
          longest = std::max(longest, std::sqrt(oracle::product(edge, edge)));
        }
      }
    spacing_ = static_cast<double>(longest) / steps;
  }
  /// No point of the boundary is farther from a sample.
  double spacing() const { return spacing_; }
  double distance(const Vec3d& p) const {
    double min = std::numeric_limits<double>::infinity();
    for (const Vec3d& q : samples_)
      min = std::min(min, (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
                              (p[2] - q[2]) * (p[2] - q[2]));
    return std::sqrt(min);
  }

private:
  bool inside(const oracle::Point& p) const {
    int winding = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      winding += bodies_[i].holds(p) ? signs_[i] : 0;
    return rule_ == InsideRule::Winding   ? winding > 0
           : rule_ == InsideRule::NonZero ? winding != 0
                                          : winding % 2 != 0;
  }
  void sample(const oracle::Polygon& face, int steps) {
    const oracle::Point u = oracle::from(face[0], face[1]), v = oracle::from(face[0], face[2]);
    const oracle::Point n = oracle::perpendicular(u, v);
    const long double hair = 1e-7L / std::sqrt(oracle::product(n, n));
    for (int i = 0; i < steps; ++i)
      for (int j = 0; i + j < steps; ++j) {
        const long double s = (i + 0.2718L) / steps, t = (j + 0.3141L) / steps;
        std::array<oracle::Point, 3> p; // in front of, on and behind the face
        for (std::size_t k = 0; k < 3; ++k)
          for (std::size_t side = 0; side < 3; ++side)
            p[side][k] = face[0][k] + s * u[k] + t * v[k] + (1.0L - side) * hair * n[k];
        if (inside(p[0]) != inside(p[2]))
          samples_.push_back({double(p[1][0]), double(p[1][1]), double(p[1][2])});
      }
  }

  InsideRule rule_;
  std::vector<oracle::Body> bodies_;
  std::vector<int> signs_;
  std::vector<Vec3d> samples_;
  double spacing_ = 0;
};

TriangleMesh facesOf(const TetMesh& tets) {
  TriangleMesh mesh;
  mesh.points = tets.points;
  for (std::size_t t = 0; t < tets.tetCount(); ++t) {
    const std::uint32_t* v = &tets.tets[4 * t];
    meshes::addTriangle(mesh, v[0], v[2], v[1]);
    meshes::addTriangle(mesh, v[0], v[1], v[3]);
    meshes::addTriangle(mesh, v[1], v[2], v[3]);
    meshes::addTriangle(mesh, v[2], v[0], v[3]);
  }
  mesh.faceCount = mesh.triangleCount();
  return mesh;
}

// Corners on an integer grid of five places a side: most soups have faces in one plane, corners on
// faces, edges on edges, equal faces and flat tets.
TEST(TrimFaces, SoupsOnAGridAgainstSampling) {
  const double voxel = 2.0 / 7; // whole numbers are on the lattice
  std::size_t cut = 0, removed = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    TetMesh tets;
    for (std::uint32_t i = 0; i < 4 * 6; ++i) {
      tets.points.push_back(
          {double(random() % 5), double(random() % 5), double(random() % (1 + seed % 5))});
      tets.tets.push_back(i);
    }
    tets.points[0] = {0, 0, 0};
    tets.points[1] = {4, 0, 0};
    tets.points[2] = {0, 4, 0};
    tets.points[3] = {1, 1, 3};
    tets.cellCount = tets.tetCount();
    SolidOptions solid;
    solid.inside = static_cast<InsideRule>(seed % 3);
    const Surface surface = surfaceOf(voxel, 3, facesOf(tets), solid);
    EXPECT_TRUE(surface.report.warnings.empty());
    cut += surface.counts.cut;
    removed += surface.counts.removed;
    const SampledSolid truth(tets, solid.inside, 48);
    const auto values = surface.grid->getConstAccessor();
    int wrong = 0;
    for (auto at = surface.grid->cbeginValueOn(); at; ++at) {
      const openvdb::Coord& c = at.getCoord();
      const double found = std::abs(double(*at));
      const double nearest = truth.distance({c.x() * voxel, c.y() * voxel, c.z() * voxel});
      const bool right = found <= nearest + kTolerance * voxel &&
                         found >= nearest - truth.spacing() - kTolerance * voxel;
      if (!right && ++wrong < 4)
        ADD_FAILURE() << "seed " << seed << ", " << c << ": " << found << ", nearest sample at "
                      << nearest;
    }
    EXPECT_EQ(wrong, 0) << "seed " << seed;
  }
  EXPECT_GT(cut, 100u);
  EXPECT_GT(removed, 50u);
}

std::string hashOf(const Surface& surface) {
  auto grids = std::make_shared<GridSet>();
  grids->all = {surface.grid};
  return hash(Volume(grids));
}

TEST(TrimFaces, SameForAnyOrderAndThreads) {
  const TriangleMesh mesh = meshes::joined(
      {meshes::sphere({0, 0, 0}, 1, 9), meshes::moved(meshes::sphere({0.9, 0, 0}, 1, 8), turned),
       meshes::moved(meshes::box(), turnedOtherwise)});
  const auto make = [](const TriangleMesh& input) {
    return hashOf(surfaceOf(0.05, 4, input, SolidOptions()));
  };
  const std::string once = make(mesh);
  EXPECT_EQ(make(meshes::shuffledFaces(mesh, 3)), once);
  tbb::task_arena one(1), many(7);
  EXPECT_EQ(one.execute([&] { return make(mesh); }), once);
  EXPECT_EQ(many.execute([&] { return make(mesh); }), once);
}

TrimmedFaces trimmed(const TriangleMesh& mesh) {
  Progress progress;
  GridTransform transform;
  transform.voxelSize = {0.01, 0.01, 0.01};
  const SnappedMesh snapped = snapPoints(mesh.points, transform, progress);
  return trimFaces(snapped, soupFaces(mesh, snapped), FillRule::Positive, progress);
}

TEST(TrimFaces, NothingChangesWhereAllIsBoundary) {
  for (const TriangleMesh& mesh :
       {meshes::sphere(), meshes::torus(), meshes::unwelded(meshes::torus()),
        meshes::joined({meshes::box(), meshes::box({2, 0, 0}, {3, 1, 1})}),
        meshes::joined({meshes::box(), meshes::box({1, 1, 1}, {2, 2, 2})})}) { // corners touch
    const TrimmedFaces result = trimmed(mesh);
    EXPECT_TRUE(result.complete);
    EXPECT_FALSE(result.changed);
    EXPECT_EQ(result.counts.removed + result.counts.cut, 0u);
  }
}

TEST(TrimFaces, TanglesAreGivenUpInTime) {
  std::mt19937 random(7);
  TriangleMesh mesh;
  const auto coordinate = [&] { return static_cast<double>(random()) * 0x1p-32; };
  for (std::uint32_t i = 0; i < 4 * 3000; ++i)
    mesh.points.push_back({coordinate(), coordinate(), coordinate()});
  TetMesh tets;
  tets.points = mesh.points;
  for (std::uint32_t i = 0; i < mesh.points.size(); ++i)
    tets.tets.push_back(i);
  const TrimmedFaces result = trimmed(facesOf(tets));
  EXPECT_FALSE(result.complete);
  EXPECT_FALSE(result.changed);
}

} // namespace
} // namespace tetvdb
