// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/SurfaceDefects.h"
#include "tetvdb/visualize/DefectMarks.h"
#include "tetvdb/visualize/Renderer.h"
#include "tetvdb/visualize/TriangleDrawable.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

Image pictureOf(TriangleMesh mesh, const Camera& camera) {
  Progress progress;
  DefectMarks marks = markDefects(mesh, progress);
  TriangleLook look;
  look.color = {0.5F, 0.5F, 0.5F};
  look.marked = std::move(marks.flipped);
  Scene scene;
  scene.drawables.push_back(std::make_shared<TriangleDrawable>(std::move(mesh), look, progress));
  scene.drawables.push_back(std::make_shared<LineDrawable>(std::move(marks.lines), 5));
  return render(scene, camera, {}, progress);
}

bool isRed(const Pixel& p) {
  return p.red > 0.5F && p.green < 0.05F && p.blue < 0.05F;
}
bool isYellow(const Pixel& p) {
  return p.red > 0.6F && p.green > 0.4F && p.blue < 0.05F;
}
bool isBlue(const Pixel& p) {
  return p.blue > 4 * p.red && p.blue > 0.2F;
}

Camera cameraAbove(const Vec3d& target, double span, int size, const char* view = "top") {
  Framing framing;
  framing.target = target;
  framing.span = span;
  framing.reach = 10;
  return Camera(viewNamed(view), {}, framing, size, size);
}

// A box without its lid, from above: a red frame of the lines' width, and no colours within.
TEST(DefectMarks, OpenEdgesAreRed) {
  TriangleMesh box = meshes::box({0, 0, 0}, {1, 1, 1});
  box = meshes::without(box, [&](std::size_t face) {
    for (std::size_t k = 0; k < 3; ++k)
      if (box.points[box.triangles[3 * face + k]][2] < 1)
        return false;
    return true;
  });
  const int size = 200;
  const Image image = pictureOf(box, cameraAbove({0.5, 0.5, 0}, 2, size));
  // The edges are at pixels 50 and 150.
  double red = 0;
  for (int x = 0; x < size; ++x) {
    const Pixel& p = image.at(x, 100);
    if (std::abs(x + 0.5 - 50) < 2 || std::abs(x + 0.5 - 150) < 2) {
      EXPECT_TRUE(isRed(p)) << x;
    } else if (std::abs(x + 0.5 - 50) > 4 && std::abs(x + 0.5 - 150) > 4) {
      EXPECT_FALSE(p.red > 2 * p.green) << x;
    }
    red += p.red > 2 * p.green ? p.alpha : 0;
  }
  EXPECT_NEAR(red, 10, 1.5);
}

// Behind a surface an open edge is not seen.
TEST(DefectMarks, HiddenEdgesAreHidden) {
  TriangleMesh box = meshes::box({0, 0, 0}, {1, 1, 1});
  box = meshes::without(box, [&](std::size_t face) {
    for (std::size_t k = 0; k < 3; ++k)
      if (box.points[box.triangles[3 * face + k]][2] > 0)
        return false;
    return true;
  });
  meshes::append(box, meshes::box({-1, -1, 2}, {2, 2, 2.5}));
  const Image image = pictureOf(box, cameraAbove({0.5, 0.5, 0}, 2, 100));
  for (const Pixel& p : image.pixels)
    EXPECT_FALSE(p.red > 1.5F * p.green);
}

TEST(DefectMarks, EdgesOfThreeFacesAreYellow) {
  TriangleMesh mesh = meshes::box({0, 0, 0}, {1, 1, 1});
  // A fin on the edge from (0, 0, 1) to (0, 1, 1).
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), {Vec3d{0, 0, 1}, Vec3d{0, 1, 1}, Vec3d{-0.5, 0.5, 1}});
  meshes::addTriangle(mesh, first, first + 1, first + 2);
  Progress progress;
  EXPECT_EQ(markDefects(mesh, progress).nonManifoldEdges, 1U);
  EXPECT_EQ(markDefects(mesh, progress).openEdges, 2U);
  const Image image = pictureOf(mesh, cameraAbove({0.5, 0.5, 0}, 4, 200));
  EXPECT_TRUE(isYellow(image.at(75, 95))); // x = 0
  EXPECT_FALSE(isYellow(image.at(90, 95)));
}

TEST(DefectMarks, FlippedFacesAreBlue) {
  TriangleMesh ball = meshes::sphere({0, 0, 0}, 1, 12);
  std::vector<std::size_t> turned = {3, 200, 201, 777};
  for (const std::size_t face : turned)
    meshes::flipFace(ball, face);
  Progress progress;
  const DefectMarks marks = markDefects(ball, progress);
  ASSERT_EQ(marks.flipped.size(), ball.triangleCount());
  for (std::size_t face = 0; face < marks.flipped.size(); ++face)
    EXPECT_EQ(marks.flipped[face], std::find(turned.begin(), turned.end(), face) != turned.end());
  EXPECT_EQ(marks.flippedFaces, 4U);
  EXPECT_TRUE(marks.lines.empty());

  TriangleMesh box = meshes::box({0, 0, 0}, {1, 1, 1});
  for (std::size_t face = 0; face < box.triangleCount(); ++face) {
    bool onTop = true;
    for (std::size_t k = 0; k < 3; ++k)
      onTop = onTop && box.points[box.triangles[3 * face + k]][2] == 1;
    if (onTop)
      meshes::flipFace(box, face);
  }
  const Image image = pictureOf(box, cameraAbove({0.5, 0.5, 0}, 2, 50));
  EXPECT_TRUE(isBlue(image.at(25, 25)));
  const Image side = pictureOf(box, cameraAbove({0.5, 0.5, 0.5}, 2, 50, "front"));
  EXPECT_FALSE(isBlue(side.at(25, 25)));
}

// Faces that cleaning drops do not put the others out of step.
TEST(DefectMarks, FlippedFacesAmongOthersThatAreDropped) {
  TriangleMesh ball = meshes::sphere({0, 0, 0}, 1, 6);
  TriangleMesh mesh;
  mesh.points = ball.points;
  for (std::size_t face = 0; face < ball.triangleCount(); ++face) {
    const std::uint32_t* v = &ball.triangles[3 * face];
    if (face % 5 == 0)
      meshes::addTriangle(mesh, v[0], v[0], v[1]); // degenerate
    meshes::addTriangle(mesh, v[0], v[1], v[2]);
    if (face % 9 == 0) { // twice more, so that one stays
      meshes::addTriangle(mesh, v[0], v[1], v[2]);
      meshes::addTriangle(mesh, v[0], v[1], v[2]);
    }
  }
  Progress progress;
  const std::size_t last = mesh.triangleCount() - 1;
  meshes::flipFace(mesh, last);
  const DefectMarks marks = markDefects(mesh, progress);
  EXPECT_EQ(marks.flippedFaces, 1U);
  EXPECT_EQ(marks.flipped[last], 1);
}

TEST(DefectMarks, CountsAreThoseOfInfo) {
  TriangleMesh mesh = meshes::withFacesFlipped(
      meshes::without(meshes::torus(), [](std::size_t face) { return face % 31 == 0; }), 0.1);
  meshes::append(mesh, meshes::box({0, 0, 0}, {1, 1, 1}));
  meshes::append(mesh, meshes::box({1, 0, 1}, {2, 1, 2})); // shares an edge
  Progress progress;
  DefectOptions options;
  options.maxIntersections = 0;
  options.windingSamples = 0;
  const SurfaceDefects defects = surfaceDefects(mesh, options, progress);
  const DefectMarks marks = markDefects(mesh, progress);
  EXPECT_EQ(marks.openEdges, defects.boundaryEdges);
  EXPECT_EQ(marks.nonManifoldEdges, defects.nonManifoldEdges);
  EXPECT_GT(marks.nonManifoldEdges, 0U);
}

// As wide near by as far away, in perspective too.
TEST(LineDrawable, WidthInPixels) {
  const LineDrawable lines(
      {{{-9, 0, -2}, {9, 0, -2}, {1, 0, 0}}, {{-9, 4, -12}, {9, 4, -12}, {0, 1, 0}}}, 4);
  Framing framing;
  framing.span = 10;
  const Camera camera(viewNamed("top"), {true, 60}, framing, 300, 300);
  int nearRows = 0, farRows = 0;
  for (int y = 0; y < 3000; ++y) {
    RayHit hit;
    if (!lines.firstHit(camera.ray(150, y / 10.0 + 0.05), hit))
      continue;
    EXPECT_FALSE(hit.lit);
    (hit.color[0] > 0.5F ? nearRows : farRows) += 1;
  }
  EXPECT_NEAR(nearRows, 40, 1);
  EXPECT_NEAR(farRows, 40, 3); // seen aslant: the ray's distance from the line, not the picture's
  EXPECT_FALSE(lines.blocks(camera.ray(150, 150)));
}

} // namespace
} // namespace tetvdb
