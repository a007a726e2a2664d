// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/visualize/Renderer.h"
#include "visualize/AnalyticScenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

using analytic::Ball;
using analytic::Layer;
using analytic::Plate;

Scene sceneOf(std::shared_ptr<const Drawable> drawable) {
  Scene scene;
  scene.drawables.push_back(std::move(drawable));
  return scene;
}

Camera cameraFor(const Scene& scene, const View& view, int width, int height,
                 const Lens& lens = {}) {
  return Camera(view, lens, frame(view, lens, width, height, scene.support()), width, height);
}

double cover(const Image& image) {
  double sum = 0;
  for (const Pixel& p : image.pixels)
    sum += p.alpha;
  return sum;
}

TEST(Renderer, SilhouetteOfABall) {
  const Scene scene = sceneOf(std::make_shared<Ball>(Vec3d{1, 2, 3}, 5.0));
  const Camera camera = cameraFor(scene, viewNamed("iso"), 320, 240);
  Progress progress;
  RenderOptions options;
  options.lighting.occlusion = false;
  const double radius = 0.46 * 240;
  const double area = kPi * radius * radius;
  EXPECT_NEAR(cover(render(scene, camera, options, progress)), area, 1e-4 * area);
}

TEST(Renderer, SilhouetteOfABallInPerspective) {
  const Scene scene = sceneOf(std::make_shared<Ball>(Vec3d{1, 2, 3}, 5.0));
  const Camera camera = cameraFor(scene, viewNamed("front"), 240, 240, {true, 60});
  Progress progress;
  const double radius = 0.46 * 240;
  const double area = kPi * radius * radius;
  EXPECT_NEAR(cover(render(scene, camera, {}, progress)), area, 1e-4 * area);
}

// Columns that a vertical edge cuts are covered as far as the edge goes.
TEST(Renderer, EdgesAreWhereTheyAre) {
  const Scene scene = sceneOf(std::make_shared<Plate>(1, Vec3d{0, 0, 0}, Vec3d{1, 0, 1}));
  const View view = viewNamed("front");
  Framing framing;
  framing.target = {0.5, 0, 0.5};
  framing.span = 2;
  // 100 pixels of 0.02: the plate covers [25, 75) pixels, moved by 0.3 of one.
  framing.target[0] -= 0.3 * 0.02;
  const Camera camera(view, {}, framing, 100, 100);
  Progress progress;
  const Image image = render(scene, camera, {}, progress);
  EXPECT_EQ(image.at(24, 50).alpha, 0);
  EXPECT_NEAR(image.at(25, 50).alpha, 0.7, 1.0 / 16);
  EXPECT_EQ(image.at(26, 50).alpha, 1);
  EXPECT_EQ(image.at(74, 50).alpha, 1);
  EXPECT_NEAR(image.at(75, 50).alpha, 0.3, 1.0 / 16);
  EXPECT_EQ(image.at(76, 50).alpha, 0);
}

TEST(Renderer, APlaneThatFacesTheLamp) {
  const Scene scene =
      sceneOf(std::make_shared<Plate>(2, Vec3d{-1, -1, 0}, Vec3d{1, 1, 0}, Rgb{0.8F, 0.5F, 0.25F}));
  const Camera camera = cameraFor(scene, viewNamed("top"), 64, 64);
  RenderOptions options;
  options.lighting.lamp = {0, 0, 2};
  options.lighting.lampLight = 0.6F;
  options.lighting.skyLight = 0.3F;
  options.lighting.groundLight = 0.1F;
  Progress progress;
  const Pixel facing = render(scene, camera, options, progress).at(32, 32);
  EXPECT_NEAR(facing.red, 0.8 * 0.9, 1e-6);
  EXPECT_NEAR(facing.green, 0.5 * 0.9, 1e-6);
  EXPECT_NEAR(facing.blue, 0.25 * 0.9, 1e-6);
  EXPECT_EQ(facing.alpha, 1);

  // The lamp 60 degrees aside: half its light.
  options.lighting.lamp = {std::sqrt(3.0), 0, 1};
  const Pixel aslant = render(scene, camera, options, progress).at(32, 32);
  EXPECT_NEAR(aslant.red, 0.8 * (0.3 + 0.3), 1e-6);

  // From below it is dark but for the ground's light.
  const Camera below = cameraFor(scene, viewNamed("bottom"), 64, 64);
  options.lighting.lamp = {0, 0, -1};
  const Pixel dark = render(scene, below, options, progress).at(32, 32);
  EXPECT_NEAR(dark.red, 0.8 * 0.1, 1e-6);
}

// A plate between the lamp and the floor: its shadow is where the lamp's rays say.
TEST(Renderer, Shadows) {
  Scene scene = sceneOf(std::make_shared<Plate>(2, Vec3d{-1, -1, 0}, Vec3d{1, 1, 0}));
  scene.drawables.push_back(std::make_shared<Plate>(2, Vec3d{0, -0.5, 0.5}, Vec3d{0.25, 0.5, 0.5}));
  Framing framing;
  framing.span = 2;
  const Camera camera(viewNamed("top"), {}, framing, 200, 200);
  RenderOptions options;
  options.lighting.lamp = {1, 0, 1}; // the shadow falls 0.5 to the left: x from -0.5 to -0.25
  options.lighting.skyLight = options.lighting.groundLight = 0;
  options.lighting.lampLight = 1;
  Progress progress;
  const Image image = render(scene, camera, options, progress);
  const double lit = std::sqrt(0.5);
  const auto at = [&](double x) { return image.at(static_cast<int>(100 + 100 * x), 100).red; };
  EXPECT_NEAR(at(-0.52), lit, 1e-6);
  EXPECT_EQ(at(-0.48), 0);
  EXPECT_EQ(at(-0.27), 0);
  EXPECT_NEAR(at(-0.23), lit, 1e-6);
  options.lighting.shadows = false;
  const Image without = render(scene, camera, options, progress);
  EXPECT_NEAR(without.at(60, 100).red, lit, 1e-6);
}

// What a wall at right angles hides of the sky, at distance a from its foot: J. R. Howell, "A
// catalog of radiation heat transfer configuration factors", B-4, on both sides of y = 0.
double hiddenByWall(double a, double y, double halfWidth, double height) {
  const auto half = [&](double b) {
    const double slant = std::sqrt(a * a + height * height);
    return (std::atan(b / a) - a / slant * std::atan(b / slant)) / (2 * kPi);
  };
  return half(halfWidth - y) + half(halfWidth + y);
}

TEST(Renderer, OcclusionInACorner) {
  Scene scene = sceneOf(std::make_shared<Plate>(2, Vec3d{-4, -4, 0}, Vec3d{4, 4, 0}));
  scene.drawables.push_back(std::make_shared<Plate>(0, Vec3d{0, -3, 0}, Vec3d{0, 3, 2}));
  Framing framing;
  framing.span = 2;
  framing.reach = 5;
  const Camera camera(viewNamed("top"), {}, framing, 128, 128);
  RenderOptions options;
  options.lighting.lampLight = 0;
  options.lighting.skyLight = options.lighting.groundLight = 1;
  options.lighting.occlusionRange = 10;
  options.refinedShare = 0;
  for (const auto& [smooth, rays] :
       std::vector<std::pair<bool, std::uint32_t>>{{false, 16}, {true, 16}, {true, 4}}) {
    options.smoothSky = smooth;
    options.skyRays = rays;
    Progress progress;
    const Image image = render(scene, camera, options, progress);
    double squares = 0, binomial = 0;
    int count = 0;
    for (int x = 68; x < 128; x += 4) {
      double found = 0, expected = 0, variance = 0;
      for (int y = 0; y < 128; ++y, ++count) {
        const double distance = (x + 0.5 - 64) / 64, along = (64 - y - 0.5) / 64;
        const double open = 1 - hiddenByWall(distance, along, 3, 2);
        found += image.at(x, y).red / 128;
        expected += open / 128;
        variance += open * (1 - open) / rays;
        const double error = image.at(x, y).red - open;
        squares += error * error;
        binomial += open * (1 - open) / rays;
      }
      // Four standard deviations of a mean of independent rays, and what smoothing bends.
      const double bound = 4 * std::sqrt(variance) / 128 + (smooth ? 0.005 : 0);
      EXPECT_NEAR(found, expected, bound) << "at column " << x;
    }
    // Rays that complement each other err less than independent ones, neighbours together less yet.
    // Without blocks that share a sequence it was 0.050 (16 rays) and 0.071 (4).
    EXPECT_LT(std::sqrt(squares / binomial), !smooth ? 0.5 : rays == 16 ? 0.04 : 0.06);
  }
}

TEST(Renderer, OcclusionEndsAtItsRange) {
  Scene scene = sceneOf(std::make_shared<Plate>(2, Vec3d{-3, -4, 0}, Vec3d{3, 4, 0}));
  scene.drawables.push_back(std::make_shared<Plate>(2, Vec3d{-3, -4, 1e-3}, Vec3d{-2.9, 4, 1e-3}));
  Framing framing;
  framing.span = 2;
  const Camera camera(viewNamed("top"), {}, framing, 16, 16);
  RenderOptions options;
  options.lighting.lampLight = 0;
  options.lighting.skyLight = options.lighting.groundLight = 1;
  options.lighting.occlusionRange = 0.1; // of a diagonal of 10
  Progress progress;
  for (const Pixel& p : render(scene, camera, options, progress).pixels)
    EXPECT_EQ(p.red, 1);
}

TEST(Renderer, MediaBeforeAndBehind) {
  Scene scene = sceneOf(
      std::make_shared<Plate>(2, Vec3d{-1, -1, 0}, Vec3d{1, 1, 0}, Rgb{0.8F, 0.4F, 0.2F}, false));
  scene.media.push_back(std::make_shared<Layer>(0.2, 0.3, Rgb{0.1F, 0.2F, 0.3F}, 0.5F));
  scene.media.push_back(std::make_shared<Layer>(-0.3, -0.2, Rgb{5, 5, 5}, 0.0F)); // hidden
  Framing framing;
  framing.span = 4;
  framing.reach = 2;
  const Camera camera(viewNamed("top"), {}, framing, 40, 40);
  Progress progress;
  const Image image = render(scene, camera, {}, progress);
  const Pixel& through = image.at(20, 20);
  EXPECT_NEAR(through.red, 0.1 + 0.5 * 0.8, 1e-6);
  EXPECT_NEAR(through.green, 0.2 + 0.5 * 0.4, 1e-6);
  EXPECT_NEAR(through.blue, 0.3 + 0.5 * 0.2, 1e-6);
  EXPECT_EQ(through.alpha, 1);
  scene.media.pop_back();
  scene.backgroundTop = scene.backgroundBottom = {0, 1, 0, 1};
  const Pixel beside = render(scene, camera, {}, progress).at(2, 2);
  EXPECT_NEAR(beside.red, 0.1, 1e-6);
  EXPECT_NEAR(beside.green, 0.2 + 0.5, 1e-6);
  EXPECT_EQ(beside.alpha, 1);
}

TEST(Renderer, BackgroundAndItsAlpha) {
  Scene scene;
  scene.backgroundTop = {1, 0, 0, 1};
  scene.backgroundBottom = {0, 0, 0, 0};
  Progress progress;
  const Image image = render(scene, Camera(viewNamed("iso"), {}, {}, 4, 4), {}, progress);
  EXPECT_EQ(image.at(0, 0), (Pixel{0.875F, 0, 0, 0.875F}));
  EXPECT_EQ(image.at(3, 3), (Pixel{0.125F, 0, 0, 0.125F}));
}

TEST(Renderer, TheSamePixelsForAnyNumberOfThreads) {
  Scene scene = sceneOf(std::make_shared<Ball>(Vec3d{0, 0, 1}, 1.0));
  scene.drawables.push_back(std::make_shared<Plate>(2, Vec3d{-2, -2, 0}, Vec3d{2, 2, 0}));
  const Camera camera = cameraFor(scene, viewNamed("iso"), 133, 71, {true, 30});
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  std::vector<Image> images;
  for (const int threads : {1, 2, 7}) {
    tbb::task_arena arena(threads);
    Progress progress;
    images.push_back(arena.execute([&] { return render(scene, camera, {}, progress); }));
  }
  EXPECT_TRUE(images[0].pixels == images[1].pixels);
  EXPECT_TRUE(images[0].pixels == images[2].pixels);
}

TEST(Renderer, Cancel) {
  const Scene scene = sceneOf(std::make_shared<Ball>(Vec3d{0, 0, 0}, 1.0));
  const Camera camera = cameraFor(scene, viewNamed("iso"), 64, 64);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(render(scene, camera, {}, progress), Error);
}

} // namespace
} // namespace tetvdb
