// SPDX-License-Identifier: Apache-2.0
//
// Grids whose pictures are known: balls, boxes and slabs, met by rays of every direction.
#include "tetvdb/core/Error.h"
#include "tetvdb/visualize/VolumeLook.h"
#include "tetvdb/volume/Grids.h"

#include <cmath>
#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <random>

namespace tetvdb {
namespace {

Vec3d unit(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Vec3d v{normal(random), normal(random), normal(random)};
  const double size = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  return {v[0] / size, v[1] / size, v[2] / size};
}

double dotOf(const Vec3d& a, const Vec3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// From far outside towards `target`.
Ray towards(const Vec3d& target, const Vec3d& direction, double from) {
  Ray ray;
  ray.direction = direction;
  for (std::size_t a = 0; a < 3; ++a)
    ray.origin[a] = target[a] - from * direction[a];
  return ray;
}

/// t at which the ray enters a ball; NaN where it passes.
double entersBall(const Ray& ray, const Vec3d& centre, double radius) {
  const Vec3d d{ray.origin[0] - centre[0], ray.origin[1] - centre[1], ray.origin[2] - centre[2]};
  const double b = dotOf(d, ray.direction), c = dotOf(d, d) - radius * radius;
  return b * b < c ? NAN : -b - std::sqrt(b * b - c);
}

const Vec3d kCentre{1.25, -3.5, 0.75};
constexpr double kRadius = 2, kVoxel = 0.1;

openvdb::FloatGrid::Ptr ballLevelSet() {
  return openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
      float(kRadius), openvdb::Vec3f(float(kCentre[0]), float(kCentre[1]), float(kCentre[2])),
      float(kVoxel));
}

/// Voxels whose centre is in the ball are active; whole blocks of them are tiles.
template <class GridT>
typename GridT::Ptr ballMask(double voxel) {
  auto grid = GridT::create();
  grid->setTransform(makeTransform({{voxel, voxel, voxel}, {0.03, 0.02, 0.01}}));
  const int reach = static_cast<int>(kRadius / voxel) + 2;
  const openvdb::Coord midpoint = grid->transform().worldToIndexNodeCentered(
      openvdb::Vec3d(kCentre[0], kCentre[1], kCentre[2]));
  auto accessor = grid->getAccessor();
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      for (int k = -reach; k <= reach; ++k) {
        const openvdb::Coord at = midpoint.offsetBy(i, j, k);
        const openvdb::Vec3d p = grid->indexToWorld(at);
        if ((p - openvdb::Vec3d(kCentre[0], kCentre[1], kCentre[2])).length() <= kRadius)
          accessor.setValueOn(at, typename GridT::ValueType(1));
      }
  grid->pruneGrid();
  return grid;
}

TEST(DrawSurface, ofALevelSetIsTheBall) {
  initializeOpenVDB();
  const auto ball = drawSurface(ballLevelSet(), {});
  std::mt19937 random(1);
  int hits = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3d aim = unit(random);
    const Ray ray = towards({kCentre[0] + 1.5 * kRadius * aim[0] * (n % 100) / 100,
                             kCentre[1] + 1.5 * kRadius * aim[1] * (n % 100) / 100,
                             kCentre[2] + 1.5 * kRadius * aim[2] * (n % 100) / 100},
                            unit(random), 30);
    const double outer = entersBall(ray, kCentre, kRadius + 0.1 * kVoxel);
    const double inner = entersBall(ray, kCentre, kRadius - 0.1 * kVoxel);
    RayHit hit;
    const bool is = ball->firstHit(ray, hit);
    EXPECT_EQ(ball->blocks(ray), is);
    if (std::isnan(outer)) {
      EXPECT_FALSE(is);
    }
    if (!std::isnan(inner)) {
      ASSERT_TRUE(is);
    }
    if (!is)
      continue;
    ++hits;
    Vec3d normal;
    for (std::size_t a = 0; a < 3; ++a)
      normal[a] = (ray.origin[a] + hit.t * ray.direction[a] - kCentre[a]) / kRadius;
    EXPECT_NEAR(std::sqrt(dotOf(normal, normal)), 1, 0.1 * kVoxel / kRadius);
    EXPECT_GT(dotOf(hit.normal, normal), 0.999);
  }
  EXPECT_GT(hits, 800);
}

/// Within a voxel of the ball; normals that differ by what voxels do to them.
void expectBall(const Drawable& drawn, double voxel, double minCosine, double pixel = 0) {
  std::mt19937 random(2);
  double cosines = 0;
  int hits = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3d direction = unit(random), aim = unit(random);
    Ray ray = towards({kCentre[0] + kRadius * aim[0] * (n % 90) / 100,
                       kCentre[1] + kRadius * aim[1] * (n % 90) / 100,
                       kCentre[2] + kRadius * aim[2] * (n % 90) / 100},
                      direction, 30);
    ray.pixel = pixel;
    RayHit hit;
    ASSERT_TRUE(drawn.firstHit(ray, hit));
    Vec3d normal;
    for (std::size_t a = 0; a < 3; ++a)
      normal[a] = (ray.origin[a] + hit.t * ray.direction[a] - kCentre[a]) / kRadius;
    const double away = std::sqrt(dotOf(normal, normal));
    EXPECT_NEAR(away, 1, 1.0 * voxel / kRadius);
    EXPECT_NEAR(dotOf(hit.normal, hit.normal), 1, 1e-9);
    cosines += dotOf(hit.normal, normal) / away;
    ++hits;
  }
  EXPECT_GT(cosines / hits, minCosine);
}

TEST(DrawSurface, ofAMaskIsNearTheBallAndSmooth) {
  initializeOpenVDB();
  for (const double voxel : {0.1, 0.05}) {
    expectBall(*drawSurface(ballMask<openvdb::BoolGrid>(voxel), {}), voxel, 0.97);
    const auto fog = ballMask<openvdb::FloatGrid>(voxel);
    fog->setName("density");
    fog->setGridClass(openvdb::GRID_FOG_VOLUME);
    expectBall(*drawSurface(fog, {}), voxel, 0.97);
    expectBall(*drawSurface(ballMask<openvdb::Int32Grid>(voxel), {}), voxel, 0.99, 6 * voxel);
  }
}

// Half-spaces of any slope, in pixels of many voxels: what cells do to normals shows as ripples.
TEST(DrawSurface, ofPlanesNormalsDoNotRipple) {
  initializeOpenVDB();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> anywhere(-12, 12);
  struct Bound {
    double pixel, mean, maxValue; // voxels, degrees
  };
  // Cells of 2, 4 and 8 voxels. Quadratic splines were at 4.2 and 9.4 for the larger two.
  for (const auto& [pixel, mean, largest] :
       {Bound{3.5, 4.5, 15}, Bound{6, 2.5, 7}, Bound{10, 2.5, 7}}) {
    double degrees = 0, maxValue = 0;
    int hits = 0;
    for (int plane = 0; plane < 12; ++plane) {
      const Vec3d n = unit(random);
      const auto grid = openvdb::BoolGrid::create();
      auto accessor = grid->getAccessor();
      for (int i = -40; i < 40; ++i)
        for (int j = -40; j < 40; ++j)
          for (int k = -40; k < 40; ++k)
            if (dotOf(n, {i + 0.5, j + 0.5, k + 0.5}) < 0)
              accessor.setValueOn({i, j, k}, true);
      const auto drawn = drawSurface(grid, {});
      for (int shot = 0; shot < 60; ++shot) {
        Vec3d at{anywhere(random), anywhere(random), anywhere(random)};
        const double off = dotOf(at, n);
        for (std::size_t a = 0; a < 3; ++a)
          at[a] += (10 - off) * n[a];
        Ray ray;
        // Voxels' centres are at whole numbers of the world.
        ray.origin = {at[0] - 0.5, at[1] - 0.5, at[2] - 0.5};
        ray.direction = {-n[0], -n[1], -n[2]};
        ray.pixel = pixel;
        RayHit hit;
        ASSERT_TRUE(drawn->firstHit(ray, hit));
        const double error = std::acos(std::min(1.0, dotOf(hit.normal, n))) * 180 / 3.14159265;
        degrees += error;
        maxValue = std::max(maxValue, error);
        ++hits;
      }
    }
    EXPECT_LT(degrees / hits, mean) << "pixels of " << pixel << " voxels";
    EXPECT_LT(maxValue, largest) << "pixels of " << pixel << " voxels";
  }
}

TEST(DrawSurface, aFlatSideOfVoxelsIsFlat) {
  initializeOpenVDB();
  auto grid = openvdb::BoolGrid::create();
  grid->fill({{-20, -20, -20}, {19, 19, 19}}, true);
  const auto box = drawSurface(grid, {});
  for (double y = -12; y < 12; y += 0.37) {
    RayHit hit;
    ASSERT_TRUE(box->firstHit({{-50, y, 0.4 * y}, {1, 0, 0}, 0, 1000}, hit));
    EXPECT_NEAR(hit.t, 29.5, 1e-3); // the face lies at -20.5
    EXPECT_NEAR(hit.normal[0], -1, 1e-9);
  }
}

TEST(DrawVoxels, meetsVoxelsWhereTheyAre) {
  initializeOpenVDB();
  auto grid = openvdb::FloatGrid::create();
  grid->setTransform(makeTransform({{0.5, 0.25, 2}, {10, 0, -3}}));
  grid->tree().setValueOn({2, -1, 4}, 7.0f); // centre 11, -0.25, 5
  VolumeLook look;
  look.paint.grid = grid;
  look.paint.colorOf = [](double v) { return Rgb{float(v), 0, 0}; };
  const auto drawn = drawVoxels(grid, look);
  const Box box = drawn->bounds();
  EXPECT_NEAR(box.low[0], 10.75, 1e-12);
  EXPECT_NEAR(box.high[1], -0.125, 1e-12);
  EXPECT_NEAR(box.high[2], 6, 1e-12);
  RayHit hit;
  ASSERT_TRUE(drawn->firstHit({{11, -0.2, 20}, {0, 0, -1}, 0, 100}, hit));
  EXPECT_NEAR(hit.t, 14, 1e-12);
  EXPECT_EQ(hit.normal, (Vec3d{0, 0, 1}));
  EXPECT_EQ(hit.color[0], 7.0f);
  EXPECT_FALSE(drawn->firstHit({{11.3, -0.2, 20}, {0, 0, -1}, 0, 100}, hit));
  EXPECT_FALSE(drawn->firstHit({{11, -0.2, 20}, {0, 0, -1}, 0, 13.9}, hit));
  // Skewed voxels: the normal still points out of the face.
  const double s = std::sqrt(0.5);
  ASSERT_TRUE(drawn->firstHit({{11, -0.25 - 3, 5 - 3}, {0, s, s}, 0, 100}, hit));
  EXPECT_EQ(hit.normal, (Vec3d{0, -1, 0}));
}

TEST(DrawVoxels, areWithinTheBallsVoxels) {
  initializeOpenVDB();
  expectBall(*drawVoxels(ballMask<openvdb::MaskGrid>(0.1), {}), 0.1 * std::sqrt(3.0) / 2, 0.5);
}

TEST(DrawVoxels, aCutShowsThePlane) {
  initializeOpenVDB();
  VolumeLook look;
  look.cut = CutPlane{{1, 0, 0}, kCentre[0] + 0.5};
  const auto voxels = drawVoxels(ballMask<openvdb::BoolGrid>(0.1), look);
  const auto surface = drawSurface(ballMask<openvdb::BoolGrid>(0.1), look);
  const auto levelSet = drawSurface(ballLevelSet(), look);
  for (const Drawable* drawn : {voxels.get(), surface.get(), levelSet.get()}) {
    RayHit hit;
    ASSERT_TRUE(drawn->firstHit({{20, kCentre[1] + 0.7, kCentre[2]}, {-1, 0, 0}, 0, 100}, hit));
    EXPECT_NEAR(hit.t, 20 - (kCentre[0] + 0.5), 1e-9);
    EXPECT_EQ(hit.normal, (Vec3d{1, 0, 0}));
    // Beside the disc of radius sqrt(4 - 0.25) there is nothing left.
    EXPECT_FALSE(drawn->firstHit({{20, kCentre[1] + 2.1, kCentre[2]}, {-1, 0, 0}, 0, 100}, hit));
  }
}

TEST(DrawSlice, showsTheVoxelsItCuts) {
  initializeOpenVDB();
  auto grid = openvdb::FloatGrid::create();
  grid->setTransform(makeTransform({{0.1, 0.1, 0.1}, {0, 0, 0}}));
  auto accessor = grid->getAccessor();
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j)
      for (int k = 0; k < 10; ++k)
        accessor.setValueOn({i, j, k}, float(100 * i + 10 * j + k));
  VolumeLook look;
  look.paint.colorOf = [](double v) { return Rgb{float(v), 0, 0}; };
  const auto slice = drawSlice(grid, 2, 0.42, look);
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) {
      RayHit hit;
      ASSERT_TRUE(slice->firstHit({{0.1 * i + 0.03, 0.1 * j - 0.04, 5}, {0, 0, -1}, 0, 100}, hit));
      EXPECT_EQ(hit.color[0], float(100 * i + 10 * j + 4));
      EXPECT_NEAR(hit.t, 4.58, 1e-12);
      EXPECT_FALSE(hit.lit);
    }
  RayHit hit;
  EXPECT_FALSE(slice->firstHit({{-0.06, 0, 5}, {0, 0, -1}, 0, 100}, hit));
  EXPECT_FALSE(slice->firstHit({{0.96, 0, 5}, {0, 0, -1}, 0, 100}, hit));
}

TEST(DrawFog, absorbsByBeerAndLambert) {
  initializeOpenVDB();
  Progress progress;
  for (const float value : {0.25f, 1.0f}) {
    auto grid = openvdb::FloatGrid::create();
    grid->setTransform(makeTransform({{0.1, 0.1, 0.1}, {0, 0, 0}}));
    // 8 x 8 x 2 units, in tiles and voxels.
    grid->fill({{0, 0, 0}, {79, 79, 19}}, value);
    FogLook look;
    look.depth = 8; // 1 a unit
    look.light = 0;
    look.ambient = 1;
    look.paint.plain = {1, 1, 1};
    const auto fog = drawFog(grid, look, progress);
    for (const double jitter : {0.0, 0.3, 0.9}) {
      Rgb light{};
      float through = 0;
      fog->gather({{4.02, 3.97, -7}, {0, 0, 1}, 0, 1e6}, jitter, light, through);
      EXPECT_NEAR(through, std::exp(-2 * value), 0.03);
      // In light from everywhere a white fog glows by what it takes away.
      EXPECT_NEAR(light[0], 1 - through, 1e-4);
      fog->gather({{4.02, 3.97, -7}, {0, 0, 1}, 0, 7.95}, jitter, light, through);
      EXPECT_NEAR(through, std::exp(-1 * value), 0.06);
      fog->gather({{40, 3.97, -7}, {0, 0, 1}, 0, 1e6}, jitter, light, through);
      EXPECT_EQ(through, 1.0f);
    }
  }
}

TEST(DrawFog, isDarkerAwayFromTheLight) {
  initializeOpenVDB();
  Progress progress;
  auto grid = openvdb::FloatGrid::create();
  grid->fill({{0, 0, 0}, {63, 63, 63}}, 1.0f);
  FogLook look;
  look.depth = 4;
  look.light = 1;
  look.ambient = 0;
  look.toLight = {0, 0, 1};
  const auto fog = drawFog(grid, look, progress);
  // A ray along x at height z meets light exp(-4 (64 - z) / 64) everywhere, and lets exp(-4)
  // through.
  for (const double z : {8.2, 31.7, 60.1}) {
    Rgb light{};
    float through = 0;
    fog->gather({{-20, 32.3, z - 0.5}, {1, 0, 0}, 0, 1e6}, 0.5, light, through);
    const double expected = 0.8 * (1 - std::exp(-4)) * std::exp(-4 * (64 - z) / 64);
    EXPECT_NEAR(light[0], expected, 0.06 * expected) << z;
  }
}

TEST(DrawVolume, reachesAsFarAsTheBall) {
  initializeOpenVDB();
  const auto voxels = drawVoxels(ballMask<openvdb::BoolGrid>(0.05), {});
  const auto surface = drawSurface(ballLevelSet(), {});
  std::mt19937 random(5);
  for (int n = 0; n < 300; ++n) {
    const Vec3d direction = unit(random);
    const double reach = dotOf(direction, kCentre) + kRadius;
    // Voxels whose centres are inside, of the level set those of the narrow band.
    EXPECT_GE(voxels->support(direction), reach - 0.05);
    EXPECT_LE(voxels->support(direction), reach + 0.05);
    EXPECT_GE(surface->support(direction), reach);
    EXPECT_LE(surface->support(direction), reach + 4 * kVoxel);
  }
}

TEST(DrawVolume, frustumsAreRefused) {
  initializeOpenVDB();
  auto grid = openvdb::FloatGrid::create();
  grid->tree().setValueOn({0, 0, 0}, 1.0f);
  grid->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd({0, 0, 0}, {10, 10, 10}), 0.5, 2));
  EXPECT_THROW(drawVoxels(grid, {}), Error);
  EXPECT_THROW(drawSurface(grid, {}), Error);
}

} // namespace
} // namespace tetvdb
