// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/visualize/Camera.h"
#include "visualize/AnalyticScenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace tetvdb {
namespace {

void expectNear(const Vec3d& a, const Vec3d& b, double error) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(a[axis], b[axis], error) << "axis " << axis;
}

TEST(Camera, NamedViewsWithZUp) {
  const Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const View front = viewNamed("front");
  expectNear(front.toEye, {0, -1, 0}, 0);
  expectNear(front.right, x, 1e-15);
  expectNear(front.up, z, 1e-15);
  const View right = viewNamed("right");
  expectNear(right.toEye, x, 0);
  expectNear(right.right, y, 1e-15);
  const View top = viewNamed("top");
  expectNear(top.right, x, 1e-15);
  expectNear(top.up, y, 1e-15);
  const View bottom = viewNamed("bottom");
  expectNear(bottom.right, x, 1e-15);
  expectNear(bottom.up, {0, -1, 0}, 1e-15);
  const View back = viewNamed("back");
  expectNear(back.right, {-1, 0, 0}, 1e-15);
  const View left = viewNamed("left");
  expectNear(left.right, {0, -1, 0}, 1e-15);
  const double third = 1 / std::sqrt(3.0);
  expectNear(viewNamed("iso").toEye, {third, -third, third}, 1e-15);
  expectNear(viewNamed("0,-2,0").toEye, {0, -1, 0}, 1e-15);
}

TEST(Camera, NamedViewsWithYUp) {
  const Vec3d up{0, 1, 0};
  const View front = viewNamed("front", up);
  expectNear(front.toEye, {0, 0, 1}, 0);
  expectNear(front.right, {1, 0, 0}, 1e-15);
  expectNear(front.up, up, 1e-15);
  const View top = viewNamed("top", up);
  expectNear(top.up, {0, 0, -1}, 1e-15);
  const double third = 1 / std::sqrt(3.0);
  expectNear(viewNamed("iso", up).toEye, {third, third, third}, 1e-15);
}

TEST(Camera, ViewsThatAreNone) {
  for (const char* name : {"", "isometric", "1,2", "0,0,0", "1,2,3,4", "1;2;3", "nan,1,1", "FRONT"})
    EXPECT_THROW(viewNamed(name), Error) << name;
  EXPECT_THROW(viewFrom({0, 0, 0}), Error);
}

TEST(Camera, AxesAreRightHandedAndSquare) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 100; ++i) {
    const View view = viewFrom({normal(random) * 1e200, normal(random), normal(random) * 1e-200});
    EXPECT_NEAR(analytic::dotOf(view.right, view.up), 0, 1e-12);
    EXPECT_NEAR(analytic::dotOf(view.right, view.toEye), 0, 1e-12);
    EXPECT_NEAR(analytic::dotOf(view.up, view.up), 1, 1e-12);
    EXPECT_NEAR(view.right[1] * view.up[2] - view.right[2] * view.up[1], view.toEye[0], 1e-12);
  }
}

// A thing that turns by a quarter, anticlockwise from above, shows its left side to the front.
TEST(Camera, TurningTheThing) {
  const View turnedView = turned(viewNamed("front"), kPi / 2), left = viewNamed("left");
  expectNear(turnedView.toEye, left.toEye, 1e-15);
  expectNear(turnedView.right, left.right, 1e-15);
  expectNear(turnedView.up, left.up, 1e-15);
}

// A cube of side 2 fills 92 % of the picture's height: its edges are at known pixels.
TEST(Camera, EdgesOfACubeWithParallelRays) {
  const Box cube{{4, -1, 2}, {6, 1, 4}};
  const View view = viewNamed("front");
  const Framing framing = frame(view, {}, 640, 480, supportOf(cube));
  const Camera camera(view, {}, framing, 640, 480);
  EXPECT_NEAR(camera.pixelAt(1), 2 / (0.92 * 480), 1e-15);
  const Camera::Projected corner = camera.project({6, -1, 4});
  EXPECT_NEAR(corner.x, 320 + 0.46 * 480, 1e-9);
  EXPECT_NEAR(corner.y, 240 - 0.46 * 480, 1e-9);
  const Camera::Projected other = camera.project({4, 1, 2});
  EXPECT_NEAR(other.x, 320 - 0.46 * 480, 1e-9);
  EXPECT_NEAR(other.y, 240 + 0.46 * 480, 1e-9);
  EXPECT_NEAR(other.depth - corner.depth, 2, 1e-12);
  EXPECT_GT(corner.depth, 0);
}

TEST(Camera, AUprightPictureIsFilledAcross) {
  const Framing framing =
      frame(viewNamed("front"), {}, 300, 900, supportOf(Box{{0, 0, 0}, {3, 1, 1}}));
  EXPECT_NEAR(framing.span, 3 / 0.92, 1e-12);
}

TEST(Camera, ABallTouchesTheMarginInPerspective) {
  const analytic::Ball ball({10, -20, 30}, 3);
  const Lens lens{true, 40};
  const View view = viewNamed("1,2,0.5");
  const Framing framing =
      frame(view, lens, 640, 480, [&](const Vec3d& d) { return ball.support(d); });
  expectNear(framing.target, {10, -20, 30}, 1e-9);
  // The eye sees the ball within a cone of sine r / distance.
  const double distance = framing.span / 2 / std::tan(20 * kPi / 180);
  EXPECT_NEAR(std::tan(std::asin(3 / distance)), 0.92 * std::tan(20 * kPi / 180), 1e-12);
}

TEST(Camera, APerspectiveFramingTouchesOnBothSides) {
  const Box box{{-1, -2, -3}, {4, 1, 0.5}};
  const Lens lens{true, 30};
  const View view = viewNamed("iso");
  const Camera camera(view, lens, frame(view, lens, 400, 300, supportOf(box)), 400, 300);
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (int i = 0; i < 8; ++i) {
    const auto p = camera.project({(i & 1 ? box.high : box.low)[0], (i & 2 ? box.high : box.low)[1],
                                   (i & 4 ? box.high : box.low)[2]});
    left = std::min(left, p.x);
    right = std::max(right, p.x);
    top = std::min(top, p.y);
    bottom = std::max(bottom, p.y);
  }
  // The margins count in parts of the angle's tangent along each side.
  EXPECT_NEAR(top, 0.04 * 300, 1e-9);
  EXPECT_NEAR(bottom, 0.96 * 300, 1e-9);
  EXPECT_GE(left, 0.04 * 400);
  EXPECT_LE(right, 0.96 * 400);
}

// Points that lie where they may: the margins left and right, and above and below, are alike, and
// those of one pair are 4 %, unless the eye would come too near.
TEST(Camera, WhatIsSeenLiesInTheMiddleOfBothSides) {
  std::mt19937 random(3);
  int sharp = 0;
  std::normal_distribution<double> normal;
  for (int n = 0; n < 200; ++n) {
    std::vector<Vec3d> points(30); // of an ellipsoid with a lump
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d d{normal(random), normal(random), normal(random)};
      const double size = std::sqrt(analytic::dotOf(d, d)) * (i % 7 ? 1 : 0.6);
      points[i] = {7 + 3 * d[0] / size, 2 * d[1] / size, -2 + d[2] / size};
    }
    const Support support = [&](const Vec3d& d) {
      double maxValue = -INFINITY;
      for (const Vec3d& p : points)
        maxValue = std::max(maxValue, analytic::dotOf(p, d));
      return maxValue;
    };
    const View view = viewFrom({normal(random), normal(random), normal(random)});
    const int width = 640, height = n % 2 ? 480 : 900;
    for (const Lens& lens : {Lens{true, 20}, Lens{true, 50}, Lens{}}) {
      const Camera camera(view, lens, frame(view, lens, width, height, support), width, height);
      double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9, nearest = 1e9;
      for (const Vec3d& point : points) {
        const Camera::Projected p = camera.project(point);
        EXPECT_GT(p.depth, 0);
        nearest = std::min(nearest, p.depth);
        left = std::min(left, p.x);
        right = std::max(right, p.x);
        top = std::min(top, p.y);
        bottom = std::max(bottom, p.y);
      }
      EXPECT_NEAR(left, width - right, 1e-2) << n;
      EXPECT_NEAR(top, height - bottom, 1e-2) << n;
      const auto extent = [&](const Vec3d& d) {
        return support(d) + support({-d[0], -d[1], -d[2]});
      };
      const double clear = 0.25 * std::max(extent(view.right), extent(view.up));
      if (lens.perspective && nearest < clear * (1 + 1e-9)) { // sharp towards the eye
        EXPECT_NEAR(nearest, clear, 1e-9 * clear) << n;
        EXPECT_GE(std::min(left / width, top / height), 0.04 - 1e-6) << n;
        ++sharp;
        continue;
      }
      EXPECT_NEAR(std::min(left / width, top / height), 0.04, 1e-6) << n;
    }
  }
  EXPECT_LT(sharp, 20); // of 400
}

// A pyramid more pointed than the picture's angle would fit with the eye at its tip.
TEST(Camera, TheEyeStaysClearOfATip) {
  const std::vector<Vec3d> points = {{0, 0, 10}, {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}};
  const Support support = [&](const Vec3d& d) {
    double maxValue = -INFINITY;
    for (const Vec3d& p : points)
      maxValue = std::max(maxValue, analytic::dotOf(p, d));
    return maxValue;
  };
  const View view = viewNamed("top");
  const Camera camera(view, {true, 60}, frame(view, {true, 60}, 200, 200, support), 200, 200);
  EXPECT_NEAR(camera.project(points[0]).depth, 0.5, 1e-9); // a quarter of 2
  for (const Vec3d& point : points) {
    const Camera::Projected p = camera.project(point);
    EXPECT_NEAR(p.x, 100 + point[0] / (10.5 - point[2]) / std::tan(30 * kPi / 180) * 100, 1e-4);
    EXPECT_NEAR(p.y, 100 - point[1] / (10.5 - point[2]) / std::tan(30 * kPi / 180) * 100, 1e-4);
  }
}

TEST(Camera, RaysGoThroughWhatIsProjected) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-1, 1);
  for (const bool perspective : {false, true}) {
    const Lens lens{perspective, 50};
    const View view = viewNamed("0.3,0.5,-0.7");
    const Box box{{-1, -1, -1}, {1, 1, 1}};
    const Camera camera(view, lens, frame(view, lens, 320, 200, supportOf(box)), 320, 200);
    for (int i = 0; i < 100; ++i) {
      const Vec3d p{place(random), place(random), place(random)};
      const Camera::Projected at = camera.project(p);
      const Ray ray = camera.ray(at.x, at.y);
      EXPECT_NEAR(analytic::dotOf(ray.direction, ray.direction), 1, 1e-12);
      const Vec3d way{p[0] - ray.origin[0], p[1] - ray.origin[1], p[2] - ray.origin[2]};
      const double t = analytic::dotOf(way, ray.direction);
      EXPECT_GT(t, 0);
      expectNear(ray.at(t), p, 1e-12);
      EXPECT_NEAR(ray.pixelAt(t), camera.pixelAt(at.depth), 1e-12);
    }
  }
}

TEST(Camera, NothingAndAPointHaveAFraming) {
  const View view = viewNamed("iso");
  EXPECT_EQ(frame(view, {}, 10, 10, supportOf(Box())).span, 1);
  const Box point{{5, 6, 7}, {5, 6, 7}};
  for (const bool perspective : {false, true}) {
    const Framing framing = frame(view, {perspective, 30}, 10, 10, supportOf(point));
    EXPECT_EQ(framing.span, 1);
    expectNear(framing.target, {5, 6, 7}, 1e-12);
  }
}

} // namespace
} // namespace tetvdb
