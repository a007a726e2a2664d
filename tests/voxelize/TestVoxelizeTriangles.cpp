// SPDX-License-Identifier: Apache-2.0
#include "TestScale.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <set>
#include <string>
#include <tbb/task_arena.h>
#include <tuple>

namespace tetvdb {
namespace {

using Voxel = std::tuple<int, int, int>;

VoxelizeOptions maskOf(int resolution) {
  VoxelizeOptions options;
  options.resolution = resolution;
  options.grids = {GridKind::Mask};
  options.allowEmpty = true;
  return options;
}

Voxelization run(const TriangleMesh& mesh, const SolidOptions& solid,
                 const VoxelizeOptions& options) {
  Report report;
  Progress progress;
  return voxelize(mesh, solid, options, report, progress);
}

const openvdb::BoolGrid& maskGrid(const Voxelization& result) {
  return *openvdb::gridConstPtrCast<openvdb::BoolGrid>(result.volume.grids().all.front());
}

std::uint64_t countOf(const Voxelization& result) {
  return describe(result.volume).front().activeVoxels;
}

// In general position: no voxel centre on a face or in line with an edge.
TriangleMesh generic(TriangleMesh mesh) {
  return meshes::moved(std::move(mesh), [](const Vec3d& p) {
    const double c = std::cos(0.37), s = std::sin(0.37);
    const Vec3d q{c * p[0] - s * p[1] + 0.01234, s * p[0] + c * p[1] - 0.04321, p[2] + 0.0031};
    return Vec3d{q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]};
  });
}

using Rule = std::function<bool(double winding)>;
bool above(double w) {
  return w > 0.5;
}

// Every voxel of the mesh's box, grown by `margin` voxels, against the definition; half as many
// along each axis where tests are not scaled up.
void expectByWinding(const TriangleMesh& mesh, const SolidOptions& solid, int resolution,
                     const Rule& inside, int margin = 6) {
  if (test::scale() == 1) {
    resolution /= 2;
    margin /= 2;
  }
  const Voxelization result = run(mesh, solid, maskOf(resolution));
  const auto accessor = maskGrid(result).getConstAccessor();
  const double h = result.transform.voxelSize[0];
  Vec3i low{}, high{};
  for (std::size_t k = 0; k < 3; ++k) {
    double a = std::numeric_limits<double>::infinity(), b = -a;
    for (const Vec3d& p : mesh.points) {
      a = std::min(a, p[k]);
      b = std::max(b, p[k]);
    }
    low[k] = static_cast<std::int32_t>(std::floor(a / h)) - margin;
    high[k] = static_cast<std::int32_t>(std::ceil(b / h)) + margin;
  }
  std::uint64_t expected = 0, undecided = 0;
  int wrong = 0;
  for (int x = low[0]; x <= high[0]; ++x)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int z = low[2]; z <= high[2]; ++z) {
        const double w = meshes::windingNumberAt(mesh, {x * h, y * h, z * h});
        // Vertices move by up to 2^-21 voxel when they are snapped.
        if (std::abs(std::abs(w) - 0.5) < kBoundaryWindingError ||
            std::abs(std::abs(w) - 1.5) < kBoundaryWindingError) {
          ++undecided;
          continue;
        }
        const bool is = accessor.isValueOn(openvdb::Coord(x, y, z));
        expected += inside(w);
        if (is != inside(w) && ++wrong < 5)
          ADD_FAILURE() << "voxel " << x << ' ' << y << ' ' << z << " winding " << w << " is "
                        << is;
      }
  EXPECT_EQ(wrong, 0);
  EXPECT_LT(undecided, 300u);
  EXPECT_LE(countOf(result), expected + undecided) << "voxels away from the mesh";
  EXPECT_GE(countOf(result), expected);
}

TriangleMesh openSphere(double share, std::uint64_t seed) {
  meshes::Random random(seed);
  return meshes::without(meshes::sphere({0, 0, 0}, 1, 10),
                         [&](std::size_t) { return random.unit() < share; });
}

TEST(VoxelizeTriangles, ClosedSolids) {
  expectByWinding(generic(meshes::box()), {}, 20, above);
  expectByWinding(generic(meshes::sphere()), {}, 30, above);
  expectByWinding(generic(meshes::torus()), {}, 40, above);
}

TEST(VoxelizeTriangles, OverlapsAndSelfIntersections) {
  expectByWinding(
      generic(meshes::joined({meshes::box(), meshes::box({0.4, 0.3, 0.2}, {1.5, 1.6, 1.7}),
                              meshes::sphere({0.9, 0.9, 0.9}, 0.6)})),
      {}, 40, above);
}

TEST(VoxelizeTriangles, NestedShells) {
  const TriangleMesh hollow =
      meshes::joined({meshes::sphere(), meshes::flipped(meshes::sphere({0.1, 0, 0}, 0.6))});
  expectByWinding(generic(hollow), {}, 30, above);
  const TriangleMesh filled = meshes::joined({meshes::sphere(), meshes::sphere({0.1, 0, 0}, 0.6)});
  expectByWinding(generic(filled), {}, 30, above);
}

// Voxel centres on faces, edges and corners: the box holds n^3 of them, whatever it abuts.
TEST(VoxelizeTriangles, LatticeBoxesAreExact) {
  VoxelizeOptions options = maskOf(0);
  options.voxelSize = {1, 1, 1};
  for (const int n : {1, 2, 3, 4})
    EXPECT_EQ(countOf(run(meshes::box({-3, 2, 5}, {5, 10, 13}, n), {}, options)), 512u);
  const TriangleMesh two =
      meshes::joined({meshes::box({0, 0, 0}, {8, 8, 8}, 2), meshes::box({8, 0, 0}, {16, 8, 8}, 3)});
  EXPECT_EQ(countOf(run(two, {}, options)), 1024u);
}

TEST(VoxelizeTriangles, BoxWithoutALid) {
  for (const std::size_t axis : {0u, 1u, 2u})
    for (const bool upper : {false, true}) {
      const TriangleMesh box = meshes::box({0, 0, 0}, {1, 1, 1}, 3);
      const TriangleMesh open = meshes::without(box, [&](std::size_t f) {
        for (std::size_t k = 0; k < 3; ++k)
          if (box.points[box.triangles[3 * f + k]][axis] != (upper ? 1.0 : 0.0))
            return false;
        return true;
      });
      ASSERT_EQ(open.triangleCount(), 90u);
      expectByWinding(generic(open), {}, 32, above, 12);
      // In its original orientation, with walls along the columns.
      expectByWinding(meshes::moved(open,
                                    [](const Vec3d& p) {
                                      return Vec3d{p[0] + 0.0101, p[1] + 0.0102, p[2] + 0.0103};
                                    }),
                      {}, 32, above, 12);
    }
}

TEST(VoxelizeTriangles, SphereWithACapMissing) {
  for (const double height : {0.9, 0.5, 0.0}) {
    const TriangleMesh ball = meshes::sphere({0, 0, 0}, 1, 12);
    const TriangleMesh open = meshes::without(
        ball, [&](std::size_t f) { return ball.points[ball.triangles[3 * f]][2] > height; });
    expectByWinding(generic(open), {}, 24, above, 9);
    expectByWinding(generic(meshes::flipped(open)), {}, 16, above, 6);
  }
}

TEST(VoxelizeTriangles, FacesMissingAnywhere) {
  for (const double share : {0.02, 0.2, 0.5, 0.9})
    expectByWinding(generic(openSphere(share, 7)), {}, 28, above, 10);
}

TEST(VoxelizeTriangles, FacesFlippedAnywhere) {
  expectByWinding(generic(meshes::withFacesFlipped(meshes::sphere(), 0.2, 3)), {}, 28, above, 10);
}

TEST(VoxelizeTriangles, SoupOfTriangles) {
  meshes::Random random(11);
  TriangleMesh soup;
  for (int i = 0; i < 300; ++i) {
    const Vec3d c{random.unit(), random.unit(), random.unit()};
    for (int k = 0; k < 3; ++k)
      soup.points.push_back({c[0] + random.between(-0.3, 0.3), c[1] + random.between(-0.3, 0.3),
                             c[2] + random.between(-0.3, 0.3)});
    const auto v = static_cast<std::uint32_t>(3 * i);
    meshes::addTriangle(soup, v, v + 1, v + 2);
  }
  expectByWinding(soup, {}, 24, above, 8);
}

// Far more winding than one around.
TEST(VoxelizeTriangles, ManySheetsOverEachOther) {
  TriangleMesh sheets;
  for (int i = 0; i < 9; ++i)
    meshes::append(sheets, meshes::sheet(2, -0.04 * i));
  expectByWinding(generic(sheets), {}, 24, above, 40);
}

TEST(VoxelizeTriangles, OpenSolidsAcrossManyNodes) {
  const TriangleMesh ball = meshes::sphere({0, 0, 0}, 1, 6);
  const TriangleMesh open = meshes::without(
      ball, [&](std::size_t f) { return ball.points[ball.triangles[3 * f]][0] > 0.6; });
  const int resolution = 300;
  const Voxelization result = run(generic(open), {}, maskOf(resolution));
  const auto accessor = maskGrid(result).getConstAccessor();
  meshes::Random random(5);
  const double h = result.transform.voxelSize[0];
  int inside = 0;
  for (int i = 0; i < 40000; ++i) {
    const openvdb::Coord voxel(int(random.between(-200, 200)), int(random.between(-200, 200)),
                               int(random.between(-200, 200)));
    const double w =
        meshes::windingNumberAt(generic(open), {voxel.x() * h, voxel.y() * h, voxel.z() * h});
    if (std::abs(w - 0.5) < kBoundaryWindingError)
      continue;
    inside += w > 0.5;
    ASSERT_EQ(accessor.isValueOn(voxel), w > 0.5) << voxel << " winding " << w;
  }
  EXPECT_GT(inside, 4000);
}

TEST(VoxelizeTriangles, InsideRules) {
  const TriangleMesh hollow = meshes::joined({meshes::sphere(), meshes::sphere({0.1, 0, 0}, 0.6),
                                              meshes::flipped(meshes::sphere({3, 0, 0}, 0.8))});
  SolidOptions solid;
  solid.inside = InsideRule::NonZero;
  expectByWinding(generic(hollow), solid, 40, [](double w) { return std::abs(w) > 0.5; });
  solid.inside = InsideRule::Parity;
  expectByWinding(generic(hollow), solid, 40, [](double w) { return (std::lround(w) & 1) != 0; });
  solid.inside = InsideRule::NonZero;
  expectByWinding(
      generic(meshes::flipped(openSphere(0.1, 3))), solid, 24,
      [](double w) { return std::abs(w) > 0.5; }, 10);
}

// Lines between neighbours that cross no face, by brute force from the corner of a small box.
TEST(VoxelizeTriangles, FloodIsWhatCannotBeReached) {
  SolidOptions flood;
  flood.inside = InsideRule::Flood;
  const TriangleMesh ball = meshes::sphere({0, 0, 0}, 1, 4);
  const TriangleMesh cases[] = {
      ball, // with a cavity, a ball aside that is inside out, and a flap
      meshes::joined({ball, meshes::flipped(meshes::sphere({0.1, 0, 0}, 0.5, 2)),
                      meshes::flipped(meshes::sphere({1.6, 0, 0}, 0.4, 2)), meshes::sheet(1, 1.3)}),
      meshes::without(ball, [](std::size_t f) { return f == 17; }), // a hole that leaks
      meshes::withFacesFlipped(ball, 0.4)};
  // Whether a face crosses the line from p along an axis, by signs of volumes.
  const auto volume = [](const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    double m[3][3];
    for (std::size_t k = 0; k < 3; ++k) {
      m[0][k] = b[k] - a[k];
      m[1][k] = c[k] - a[k];
      m[2][k] = d[k] - a[k];
    }
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  };
  int filled = 0;
  for (const TriangleMesh& given : cases) {
    const TriangleMesh mesh = generic(given);
    VoxelizeOptions options = maskOf(0);
    options.voxelSize = {0.15, 0.13, 0.14};
    const Voxelization result = run(mesh, flood, options);
    const auto accessor = maskGrid(result).getConstAccessor();
    const auto crosses = [&](Vec3d p, std::size_t axis, double length) {
      Vec3d q = p; // both ends a hundredth farther out
      q[axis] += 1.01 * length;
      p[axis] -= 0.01 * length;
      for (std::size_t f = 0; f < mesh.triangleCount(); ++f) {
        const Vec3d &a = mesh.points[mesh.triangles[3 * f]],
                    &b = mesh.points[mesh.triangles[3 * f + 1]],
                    &c = mesh.points[mesh.triangles[3 * f + 2]];
        if ((volume(a, b, c, p) > 0) == (volume(a, b, c, q) > 0))
          continue;
        const bool ab = volume(p, q, a, b) > 0, bc = volume(p, q, b, c) > 0,
                   ca = volume(p, q, c, a) > 0;
        if (ab == bc && bc == ca)
          return true;
      }
      return false;
    };
    constexpr int kLow = -10, kHigh = 18;
    std::set<Voxel> reached{{kLow, kLow, kLow}};
    std::vector<Voxel> stack{{kLow, kLow, kLow}};
    while (!stack.empty()) {
      const auto [x, y, z] = stack.back();
      stack.pop_back();
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          int n[3] = {x, y, z};
          n[axis] += step;
          if (n[axis] < kLow || n[axis] > kHigh || reached.count({n[0], n[1], n[2]}) != 0)
            continue;
          const Vec3d& h = options.voxelSize;
          if (crosses({x * h[0], y * h[1], z * h[2]}, axis, step * h[axis]))
            continue;
          reached.insert({n[0], n[1], n[2]});
          stack.push_back({n[0], n[1], n[2]});
        }
    }
    int wrong = 0;
    for (int x = kLow; x <= kHigh; ++x)
      for (int y = kLow; y <= kHigh; ++y)
        for (int z = kLow; z <= kHigh; ++z) {
          const bool inside = reached.count({x, y, z}) == 0;
          filled += inside;
          wrong += inside != accessor.isValueOn(openvdb::Coord(x, y, z));
        }
    EXPECT_EQ(wrong, 0);
  }
  EXPECT_GT(filled, 3000);
}

TEST(VoxelizeTriangles, FloodOfAMeshBetweenVoxelCentres) {
  SolidOptions flood;
  flood.inside = InsideRule::Flood;
  VoxelizeOptions options = maskOf(0);
  options.voxelSize = {1, 1, 1};
  EXPECT_EQ(countOf(run(meshes::box({0.45, 0.45, 0.45}, {0.55, 0.55, 0.55}), flood, options)), 0u);
}

TEST(VoxelizeTriangles, ParityNeedsNoOrientation) {
  SolidOptions parity;
  parity.inside = InsideRule::Parity;
  const TriangleMesh ball = generic(meshes::sphere());
  EXPECT_EQ(hash(run(ball, parity, maskOf(30)).volume), hash(run(ball, {}, maskOf(30)).volume));
  EXPECT_EQ(hash(run(meshes::withFacesFlipped(ball, 0.5), parity, maskOf(30)).volume),
            hash(run(ball, {}, maskOf(30)).volume));
  EXPECT_THROW(run(generic(openSphere(0.1, 3)), parity, maskOf(30)), Error);
}

double distanceToTriangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  // By brute force over a fine grid of the triangle, then a golden-section-like refinement.
  double best = std::numeric_limits<double>::infinity();
  double u0 = 0, v0 = 0, size = 1;
  for (int round = 0; round < 12; ++round) {
    double bu = u0, bv = v0;
    for (int i = 0; i <= 16; ++i)
      for (int j = 0; j <= 16; ++j) {
        const double u = std::clamp(u0 + size * i / 16, 0.0, 1.0);
        const double v = std::clamp(v0 + size * j / 16, 0.0, 1.0 - u);
        double d = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          const double e = a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]) - p[k];
          d += e * e;
        }
        if (d < best) {
          best = d;
          bu = u;
          bv = v;
        }
      }
    size /= 4;
    u0 = std::max(0.0, bu - size / 2);
    v0 = std::max(0.0, bv - size / 2);
  }
  return std::sqrt(best);
}

TEST(VoxelizeTriangles, ShellIsWhatIsNear) {
  meshes::Random random(4);
  TriangleMesh soup;
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 3; ++k)
      soup.points.push_back({random.unit(), random.unit(), random.unit()});
    const auto v = static_cast<std::uint32_t>(3 * i);
    meshes::addTriangle(soup, v, v + 1, v + 2);
  }
  soup.points.insert(soup.points.end(), {{0.1, 0.1, 0}, {0.1, 0.1, 1}, {0.1, 0.1, 0.4}}); // flat
  meshes::addTriangle(soup, 12, 13, 14);
  SolidOptions solid;
  solid.shell = 0.2;
  VoxelizeOptions options = maskOf(16);
  options.voxelSize = {0.05, 0.04, 0.06};
  const Voxelization result = run(soup, solid, options);
  const auto accessor = maskGrid(result).getConstAccessor();
  int inside = 0;
  for (int x = -6; x <= 26; ++x)
    for (int y = -6; y <= 31; ++y)
      for (int z = -6; z <= 22; ++z) {
        double d = std::numeric_limits<double>::infinity();
        for (std::size_t f = 0; f < soup.triangleCount(); ++f)
          d = std::min(d, distanceToTriangle({x * 0.05, y * 0.04, z * 0.06},
                                             soup.points[soup.triangles[3 * f]],
                                             soup.points[soup.triangles[3 * f + 1]],
                                             soup.points[soup.triangles[3 * f + 2]]));
        if (std::abs(d - 0.1) < 1e-4)
          continue;
        inside += d < 0.1;
        ASSERT_EQ(accessor.isValueOn(openvdb::Coord(x, y, z)), d < 0.1)
            << x << ' ' << y << ' ' << z << " distance " << d;
      }
  EXPECT_GT(inside, 1000);
}

TEST(VoxelizeTriangles, SheetsHaveNoInsideButAShell) {
  VoxelizeOptions options = maskOf(40);
  options.allowEmpty = false;
  try {
    run(meshes::sheet(), {}, options);
    FAIL() << "a sheet was filled";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Invalid);
    EXPECT_NE(std::string(error.what()).find("`shell"), std::string::npos) << error.what();
  }
  SolidOptions shell;
  shell.shell = 0.2;
  EXPECT_GT(countOf(run(meshes::sheet(), shell, options)), 40u * 40u * 4u);
}

// Between two layers of voxel centres. Voxels of the size that is advised find it.
TEST(VoxelizeTriangles, PlatesWithoutVoxelCentresNameTheSizeThatHasSome) {
  const TriangleMesh plate = meshes::box({0, 0, 0.01}, {10, 10, 0.03});
  VoxelizeOptions options = maskOf(40);
  options.allowEmpty = false;
  try {
    run(plate, {}, options);
    FAIL() << "there is a voxel centre in the plate";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Invalid);
    EXPECT_NE(std::string(error.what()).find("at most 0.0199,"), std::string::npos)
        << error.what(); // 2 * 2 / (200 + 4 * 0.2)
  }
  options.voxelSize = {0.0199, 0.0199, 0.0199};
  EXPECT_GT(countOf(run(plate, {}, options)), 250000u);
}

// A wide sheet with a small bowl in it.
TEST(VoxelizeTriangles, WarnsOfNextToNothing) {
  const TriangleMesh ball = meshes::sphere({0.5, 0.5, 0}, 0.03, 6);
  TriangleMesh mesh = meshes::without(
      ball, [&](std::size_t f) { return ball.points[ball.triangles[3 * f]][2] > 0.015; });
  const auto codes = [](const TriangleMesh& m) {
    Report report;
    Progress progress;
    voxelize(m, {}, maskOf(100), report, progress);
    std::set<std::string> found;
    for (const Warning& warning : report.warnings)
      found.insert(warning.code);
    return found;
  };
  EXPECT_EQ(codes(mesh).count("nearly-empty"), 0u);
  meshes::append(mesh, meshes::sheet(4, -0.5));
  EXPECT_EQ(codes(mesh).count("nearly-empty"), 1u);
}

// A flat sheet at voxel centres: the winding number there is a half but for rounding.
TEST(VoxelizeTriangles, FlatSheetsAreNotSpeckled) {
  VoxelizeOptions options = maskOf(0);
  options.voxelSize = {1, 1, 1};
  for (const auto inside : {InsideRule::Winding, InsideRule::NonZero}) {
    SolidOptions solid;
    solid.inside = inside;
    for (const TriangleMesh& sheet : {meshes::sheet(3, 0), meshes::flipped(meshes::sheet(3, 0))}) {
      const auto large = [](int a, int b, int c) {
        return [=](const Vec3d& p) {
          Vec3d q{};
          q[std::size_t(a)] = p[0] * 30;
          q[std::size_t(b)] = p[1] * 30;
          q[std::size_t(c)] = p[2] + 4;
          return q;
        };
      };
      EXPECT_EQ(countOf(run(meshes::moved(sheet, large(0, 1, 2)), solid, options)), 0u);
      EXPECT_EQ(countOf(run(meshes::moved(sheet, large(1, 2, 0)), solid, options)), 0u);
      EXPECT_EQ(countOf(run(meshes::moved(sheet, large(2, 0, 1)), solid, options)), 0u);
    }
  }
}

TEST(VoxelizeTriangles, IndependentOfOrderAndThreads) {
  const TriangleMesh mesh = generic(openSphere(0.3, 5));
  const std::string expected = hash(run(mesh, {}, maskOf(150)).volume);
  EXPECT_EQ(hash(run(meshes::shuffledFaces(mesh, 3), {}, maskOf(150)).volume), expected);
  for (const int threads : {1, 2, 5}) {
    tbb::task_arena arena(threads);
    arena.execute([&] { EXPECT_EQ(hash(run(mesh, {}, maskOf(150)).volume), expected); });
  }
}

TEST(VoxelizeTriangles, RefusesWhatNeedsTets) {
  VoxelizeOptions options = maskOf(10);
  options.grids = {GridKind::TetId};
  EXPECT_THROW(run(meshes::box(), {}, options), Error);
  EXPECT_THROW(run(TriangleMesh(), {}, maskOf(10)), Error);
  TriangleMesh broken = meshes::box();
  broken.points[0][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(run(broken, {}, maskOf(10)), Error);
  SolidOptions solid;
  solid.shell = -1;
  EXPECT_THROW(run(meshes::box(), solid, maskOf(10)), Error);
}

} // namespace
} // namespace tetvdb
