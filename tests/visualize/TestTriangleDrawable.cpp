// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/visualize/CornerNormals.h"
#include "tetvdb/visualize/Renderer.h"
#include "tetvdb/visualize/TriangleDrawable.h"
#include "visualize/AnalyticScenes.h"

#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

TriangleMesh square(double z, double side = 1) {
  TriangleMesh mesh;
  mesh.points = {{0, 0, z}, {side, 0, z}, {side, side, z}, {0, side, z}};
  mesh.triangles = {0, 1, 2, 0, 2, 3};
  return mesh;
}

Image pictureOf(std::shared_ptr<const Drawable> drawable, const std::string& view, int size,
                const RenderOptions& options = {}) {
  Scene scene;
  scene.drawables.push_back(std::move(drawable));
  const View seen = viewNamed(view);
  const Camera camera(seen, {}, frame(seen, {}, size, size, scene.support()), size, size);
  Progress progress;
  return render(scene, camera, options, progress);
}

TEST(TriangleDrawable, HitsAreWhereTheFacesAre) {
  Progress progress;
  // Far from the origin, where floats know no tenths.
  TriangleMesh mesh = square(0.25);
  for (Vec3d& p : mesh.points)
    p = {p[0] + 1e7, p[1] - 3e7, p[2] + 5e6};
  const TriangleDrawable drawable(mesh, {}, progress);
  Ray ray;
  ray.origin = {1e7 + 0.3, -3e7 + 0.6, 5e6 + 100};
  ray.direction = {0, 0, -1};
  RayHit hit;
  ASSERT_TRUE(drawable.firstHit(ray, hit));
  EXPECT_NEAR(hit.t, 99.75, 1e-6);
  EXPECT_NEAR(hit.normal[2], 1, 1e-6);
  EXPECT_TRUE(drawable.blocks(ray));
  ray.tMax = 99.7;
  EXPECT_FALSE(drawable.firstHit(ray, hit));
  EXPECT_FALSE(drawable.blocks(ray));
  ray.tMax = 1000;
  ray.tMin = 99.8;
  EXPECT_FALSE(drawable.blocks(ray));
  ray.tMin = 0;
  ray.origin[0] += 1;
  EXPECT_FALSE(drawable.blocks(ray));
  // From behind the normal looks the other way.
  ray.origin = {1e7 + 0.3, -3e7 + 0.6, 5e6 - 1};
  ray.direction = {0, 0, 1};
  ASSERT_TRUE(drawable.firstHit(ray, hit));
  EXPECT_NEAR(hit.normal[2], -1, 1e-6);
}

// Large meshes have another search tree, and their points are freed in blocks.
TEST(TriangleDrawable, HitsOfALargeSoup) {
  constexpr std::uint32_t kSide = 512; // squares along x and y
  const auto height = [](double x, double y) { return 0.3 * x + 0.2 * y; };
  TriangleMesh mesh;
  const auto add = [&](std::uint32_t i, std::uint32_t j) {
    const double x = double(i) / kSide, y = double(j) / kSide;
    mesh.triangles.push_back(static_cast<std::uint32_t>(mesh.points.size()));
    mesh.points.push_back({x, y, height(x, y)});
  };
  for (std::uint32_t i = 0; i < kSide; ++i)
    for (std::uint32_t j = 0; j < kSide; ++j) {
      add(i, j), add(i + 1, j), add(i + 1, j + 1);
      add(i, j), add(i + 1, j + 1), add(i, j + 1);
    }
  TriangleLook look;
  look.values.on = SurfaceValues::On::Faces;
  for (std::uint32_t face = 0; face < 2 * kSide * kSide; ++face)
    look.values.values.push_back(float(face % 251));
  look.values.scale.low = 0;
  look.values.scale.high = 250;
  const ColorScale scale = look.values.scale;
  Progress progress;
  const TriangleDrawable drawable(std::move(mesh), look, progress);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> inside(0, 1);
  for (int k = 0; k < 2000; ++k) {
    const bool onCorner = k % 4 == 0;
    double x = inside(random), y = inside(random);
    if (onCorner) {
      x = std::round(x * kSide) / kSide;
      y = std::round(y * kSide) / kSide;
    }
    Ray ray;
    ray.origin = {x, y, 2};
    ray.direction = {0, 0, -1};
    RayHit hit;
    ASSERT_TRUE(drawable.firstHit(ray, hit)) << x << " " << y;
    EXPECT_NEAR(hit.t, 2 - height(x, y), 1e-6);
    const double i = std::floor(x * kSide), j = std::floor(y * kSide);
    const double right = x * kSide - i, back = y * kSide - j;
    const auto nearEdge = [](double a) { return a < 1e-3 || a > 1 - 1e-3; };
    if (nearEdge(right) || nearEdge(back) || std::abs(right - back) < 1e-3)
      continue;
    const auto face = static_cast<std::uint32_t>(2 * (i * kSide + j)) + (back > right);
    EXPECT_EQ(hit.color, scale(face % 251)) << x << " " << y;
  }
}

// What starts a skin off the surface does not meet the surface.
TEST(TriangleDrawable, TheSkinIsEnough) {
  Progress progress;
  const TriangleDrawable drawable(meshes::sphere({0, 0, 0}, 1.0, 40), {}, progress);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    Vec3d d{normal(random), normal(random), normal(random)};
    const double size = std::sqrt(analytic::dotOf(d, d));
    return Vec3d{d[0] / size, d[1] / size, d[2] / size};
  };
  int blocked = 0, hits = 0;
  for (int i = 0; i < 20000; ++i) {
    Ray ray;
    const Vec3d from = direction();
    ray.origin = {3 * from[0], 3 * from[1], 3 * from[2]};
    ray.direction = {-from[0], -from[1], -from[2]};
    RayHit hit;
    ASSERT_TRUE(drawable.firstHit(ray, hit));
    const Vec3d at = ray.at(hit.t);
    Ray away;
    for (std::size_t axis = 0; axis < 3; ++axis)
      away.origin[axis] = at[axis] + drawable.skin() * hit.normal[axis];
    away.direction = direction();
    if (analytic::dotOf(away.direction, hit.normal) < 0)
      continue;
    ++hits;
    blocked += drawable.blocks(away); // the ball is convex
  }
  EXPECT_GT(hits, 9000);
  EXPECT_EQ(blocked, 0);
}

TEST(TriangleDrawable, SilhouetteOfABall) {
  Progress progress;
  TriangleMesh ball = meshes::sphere({0, 0, 0}, 2.0, 70);
  const double edge = std::sqrt(4 * kPi * 4 / static_cast<double>(ball.triangleCount()));
  const Image image = pictureOf(
      std::make_shared<TriangleDrawable>(std::move(ball), TriangleLook(), progress), "iso", 400);
  double cover = 0;
  for (const Pixel& p : image.pixels)
    cover += p.alpha;
  const double radius = 0.46 * 400, area = kPi * radius * radius;
  EXPECT_NEAR(cover, area, area * edge * edge / 8 + 1e-4 * area); // chords lie within
}

TEST(TriangleDrawable, AFacingSquareHasItsColour) {
  Progress progress;
  TriangleLook look;
  look.color = {0.5F, 0.25F, 0.125F};
  RenderOptions options;
  options.lighting.lamp = {0, 0, 1};
  options.lighting.lampLight = 0.5F;
  options.lighting.skyLight = 0.5F;
  const Image image =
      pictureOf(std::make_shared<TriangleDrawable>(square(0), look, progress), "top", 64, options);
  for (int y = 10; y < 54; ++y)
    for (int x = 10; x < 54; ++x) {
      EXPECT_NEAR(image.at(x, y).red, 0.5, 1e-5);
      EXPECT_NEAR(image.at(x, y).green, 0.25, 1e-5);
      EXPECT_NEAR(image.at(x, y).blue, 0.125, 1e-5);
    }
}

// Lines along the edges of the square and its diagonal: so many pixels wide, half of it outside.
TEST(TriangleDrawable, WiresHaveTheirWidth) {
  Progress progress;
  TriangleLook look;
  look.wire = true;
  look.wirePixels = 6;
  look.color = {1, 1, 1};
  RenderOptions options;
  options.lighting.lamp = {0, 0, 1};
  options.lighting.lampLight = 1;
  options.lighting.skyLight = 0;
  const int size = 200;
  const Image image = pictureOf(std::make_shared<TriangleDrawable>(square(0), look, progress),
                                "top", size, options);
  // A row at 3/4 of the height: left edge, diagonal, right edge.
  double dark = 0;
  const int row = 100 + static_cast<int>(0.23 * size);
  for (int x = 0; x < size; ++x)
    dark += image.at(x, row).alpha - image.at(x, row).red;
  // 3 pixels within the edges on either side, 6 of the diagonal along the row times sqrt 2; lines
  // keep 8 % of the light.
  EXPECT_NEAR(dark, 0.92 * (6 + 6 * std::sqrt(2.0)), 0.6);
}

TEST(TriangleDrawable, ValuesOnPointsAndFaces) {
  Progress progress;
  TriangleLook look;
  look.values.on = SurfaceValues::On::Points;
  look.values.values = {0, 1, 1, 0}; // grows with x
  look.values.scale = {&ColorMap::named("viridis"), 0, 2, false, "", {}};
  const TriangleDrawable points(square(0), look, progress);
  Ray ray;
  ray.direction = {0, 0, -1};
  for (const double x : {0.1, 0.5, 0.9}) {
    ray.origin = {x, 0.35, 1};
    RayHit hit;
    ASSERT_TRUE(points.firstHit(ray, hit));
    const Rgb wanted = ColorMap::named("viridis")(x / 2);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(hit.color[c], wanted[c], 1e-4);
  }
  look.values.on = SurfaceValues::On::Faces;
  look.values.values = {2, NAN};
  const TriangleDrawable faces(square(0), look, progress);
  RayHit hit;
  ray.origin = {0.9, 0.1, 1};
  ASSERT_TRUE(faces.firstHit(ray, hit));
  EXPECT_EQ(hit.color, ColorMap::named("viridis")(1));
  ray.origin = {0.1, 0.9, 1};
  ASSERT_TRUE(faces.firstHit(ray, hit));
  EXPECT_EQ(hit.color, colorOfNothing());
}

TEST(TriangleDrawable, ACutShowsTheInside) {
  Progress progress;
  TriangleLook look;
  look.cut = CutPlane{{0, 0, 1}, 0.0};
  const TriangleDrawable half(meshes::sphere({0, 0, 0}, 1.0, 40), look, progress);
  Ray ray;
  ray.origin = {0.2, 0.1, 5};
  ray.direction = {0, 0, -1};
  RayHit hit;
  ASSERT_TRUE(half.firstHit(ray, hit));
  EXPECT_NEAR(hit.t, 5 + std::sqrt(1 - 0.05), 1e-3); // the far side, seen from within
  EXPECT_GT(hit.normal[2], 0.9);
  ray.origin = {-5, 0, 0.5};
  ray.direction = {1, 0, 0};
  EXPECT_FALSE(half.blocks(ray));
}

TEST(TriangleDrawable, MeshesWithoutFaces) {
  Progress progress;
  const TriangleDrawable nothing(TriangleMesh(), {}, progress);
  RayHit hit;
  EXPECT_FALSE(nothing.firstHit(Ray(), hit));
  EXPECT_FALSE(nothing.blocks(Ray()));
  EXPECT_EQ(nothing.support({1, 0, 0}), -std::numeric_limits<double>::infinity());
  TriangleMesh point;
  point.points = {{1, 2, 3}};
  point.triangles = {0, 0, 0};
  const TriangleDrawable flat(point, {}, progress);
  EXPECT_FALSE(flat.blocks(Ray()));
}

TEST(TriangleDrawable, SupportIsThatOfTheFaces) {
  Progress progress;
  TriangleMesh mesh = square(0);
  mesh.points.push_back({100, 100, 100}); // no face uses it
  const TriangleDrawable drawable(mesh, {}, progress);
  EXPECT_NEAR(drawable.support({1, 0, 0}), 1, 1e-6);
  EXPECT_NEAR(drawable.support({-1, -2, 5}), 0, 1e-6);
  EXPECT_EQ(drawable.bounds().high[0], 1);
}

// A smoothed ball is shaded as the true one, everywhere but at the silhouette.
TEST(TriangleDrawable, SmoothShading) {
  Progress progress;
  TriangleLook look;
  look.smooth = true;
  const TriangleDrawable ball(meshes::sphere({0, 0, 0}, 1.0, 20), look, progress);
  Ray ray;
  ray.direction = {0, 0, -1};
  double worst = 0;
  for (double x = -0.6; x <= 0.6; x += 0.037)
    for (double y = -0.6; y <= 0.6; y += 0.041) {
      ray.origin = {x, y, 3};
      RayHit hit;
      ASSERT_TRUE(ball.firstHit(ray, hit));
      const Vec3d exact{x, y, std::sqrt(1 - x * x - y * y)};
      worst = std::max(worst, 1 - analytic::dotOf(hit.normal, exact));
    }
  EXPECT_LT(std::acos(1 - worst) * 180 / kPi, 0.6); // faces span 5 degrees
}

TEST(CornerNormals, PackingIsNearlyExact) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    std::array<float, 3> n = {normal(random), normal(random), normal(random)};
    if (i < 27)
      n = {float(i % 3 - 1), float(i / 3 % 3 - 1), float(i / 9 - 1)};
    const float size = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (size == 0)
      continue;
    const auto back = unpackNormal(packNormal(n));
    double away = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      away += std::pow(double(back[axis]) - double(n[axis] / size), 2);
    worst = std::max(worst, std::sqrt(away));
  }
  EXPECT_LT(worst * 180 / kPi, 0.004);
}

// The edges of a cube are sharper than the crease: its normals stay those of its faces, also where
// corners are not shared.
TEST(CornerNormals, CreasesStaySharp) {
  Progress progress;
  const TriangleMesh cube = meshes::box({0, 0, 0}, {1, 1, 1});
  const auto normals = cornerNormals(cube, 40, progress);
  for (std::size_t corner = 0; corner < normals.size(); ++corner) {
    const auto n = unpackNormal(normals[corner]);
    EXPECT_NEAR(std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])}), 1, 1e-6);
  }
  EXPECT_EQ(cornerNormals(meshes::unwelded(cube), 40, progress), normals);
  const auto round = cornerNormals(cube, 180, progress);
  const auto n = unpackNormal(round[0]);
  EXPECT_LT(std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])}), 0.75);
}

TEST(TriangleDrawable, TheSamePixelsForAnyNumberOfThreads) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  std::vector<Image> images;
  for (const int threads : {1, 2, 5}) {
    tbb::task_arena arena(threads);
    images.push_back(arena.execute([&] {
      Progress progress;
      TriangleLook look;
      look.smooth = true;
      look.wire = true;
      return pictureOf(
          std::make_shared<TriangleDrawable>(meshes::sphere({0, 0, 0}, 1.0, 40), look, progress),
          "iso", 120);
    }));
  }
  EXPECT_TRUE(images[0].pixels == images[1].pixels);
  EXPECT_TRUE(images[0].pixels == images[2].pixels);
}

// --- Cuts.

void append(TriangleMesh& mesh, const TriangleMesh& other, bool reversed = false) {
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
  for (std::size_t i = 0; i < other.triangles.size(); i += 3) {
    mesh.triangles.push_back(first + other.triangles[i]);
    mesh.triangles.push_back(first + other.triangles[i + (reversed ? 2 : 1)]);
    mesh.triangles.push_back(first + other.triangles[i + (reversed ? 1 : 2)]);
  }
}

/// The area that rays along +y find in the cap's colour on the plane y = at, of a drawing that is
/// cut there and lies within 3 units of the origin.
double capArea(TriangleMesh mesh, double at) {
  Progress progress;
  TriangleLook look;
  look.closure = closureOf(mesh, progress);
  look.cut = CutPlane{{0, -1, 0}, -at};
  const TriangleDrawable drawable(std::move(mesh), look, progress);
  constexpr int kRays = 600;
  constexpr double kStep = 6.0 / kRays;
  std::size_t caps = 0;
  for (int i = 0; i < kRays; ++i)
    for (int j = 0; j < kRays; ++j) {
      Ray ray;
      ray.origin = {-3 + (i + 0.5) * kStep, -10, -3 + (j + 0.5) * kStep};
      ray.direction = {0, 1, 0};
      RayHit hit;
      if (!drawable.firstHit(ray, hit) || hit.color != look.capColor)
        continue;
      ++caps;
      EXPECT_NEAR(hit.t, 10 + at, 1e-9);
      EXPECT_EQ(hit.normal, (Vec3d{0, -1, 0}));
      EXPECT_TRUE(drawable.blocks(ray));
    }
  return static_cast<double>(caps) * kStep * kStep;
}

constexpr double kBallArea = 1e-2; // facets lie within the ball, rays are a hundredth apart

TEST(TriangleDrawable, ACutBallIsFilled) {
  for (const double at : {-1.7, -0.31, 0.4}) {
    const double area = kPi * (4 - at * at);
    EXPECT_NEAR(capArea(meshes::sphere({0, 0, 0}, 2, 60), at), area, kBallArea * area) << at;
  }
}

TEST(TriangleDrawable, ACutBoxIsFilled) {
  const TriangleMesh box = meshes::box({-1, -2, 0.5}, {2, 1, 1.25}, 3);
  EXPECT_NEAR(capArea(box, -0.3), 3 * 0.75, 1e-9); // its sides lie between rays
  EXPECT_EQ(capArea(box, 1.1), 0);
}

TEST(TriangleDrawable, ACavityStaysEmpty) {
  TriangleMesh shell = meshes::sphere({0, 0, 0}, 2, 60);
  append(shell, meshes::sphere({0.1, 0, 0}, 1, 60), true);
  EXPECT_NEAR(capArea(shell, 0.2), kPi * (4 - 0.04) - kPi * (1 - 0.04), kBallArea * kPi * 4);
}

TEST(TriangleDrawable, SolidsThatOverlapAreOne) {
  TriangleMesh pair = meshes::box({-2, -1, -1}, {0.5, 1, 1}, 2);
  append(pair, meshes::box({-0.5, -1.5, 0}, {2.5, 1.5, 2}, 2));
  EXPECT_NEAR(capArea(pair, 0.3), 2.5 * 2 + 3 * 2 - 1 * 1, 1e-9);
}

TEST(TriangleDrawable, FlippedFacesAreNoHoles) {
  TriangleMesh ball = meshes::sphere({0, 0, 0}, 2, 60);
  for (std::size_t i = 0; i < ball.triangles.size(); i += 3 * 7)
    std::swap(ball.triangles[i], ball.triangles[i + 1]);
  Progress progress;
  EXPECT_EQ(closureOf(ball, progress), Closure::Parity);
  EXPECT_NEAR(capArea(std::move(ball), 0.4), kPi * (4 - 0.16), kBallArea * kPi * 4);
}

TEST(TriangleDrawable, WhatIsOpenStaysAShell) {
  Progress progress;
  TriangleMesh ball = meshes::sphere({0, 0, 0}, 2, 60);
  EXPECT_EQ(closureOf(ball, progress), Closure::Winding);
  ball.triangles.resize(ball.triangles.size() - 3);
  EXPECT_EQ(closureOf(ball, progress), Closure::Open);
  EXPECT_EQ(capArea(ball, 0.4), 0);
  EXPECT_EQ(closureOf({}, progress), Closure::Open);
}

// As soups have it, without shared points.
TEST(TriangleDrawable, ASoupOfAClosedSurfaceIsClosed) {
  Progress progress;
  const TriangleMesh box = meshes::box({-1, -1, -1}, {1, 1, 1}, 2);
  TriangleMesh soup;
  for (const std::uint32_t corner : box.triangles) {
    soup.triangles.push_back(static_cast<std::uint32_t>(soup.points.size()));
    soup.points.push_back(box.points[corner]);
  }
  EXPECT_EQ(closureOf(soup, progress), Closure::Winding);
  EXPECT_NEAR(capArea(std::move(soup), 0.3), 4, 1e-9);
}

} // namespace
} // namespace tetvdb
