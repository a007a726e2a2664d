// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/print/LayerSource.h"
#include "tetvdb/print/MeshLayers.h"
#include "tetvdb/print/OffsetRows.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

// What the box's two edges along the rows can be off by: each half of the distance of two lines.
double alongRows(LayerShare share) {
  const int lines = share == LayerShare::Volume ? 8 : 32;
  return 10.3 * 0.5 / lines;
}

// Pixels that are not square.
LayerFrame frame() {
  LayerFrame result;
  result.width = 120;
  result.height = 90;
  result.pixelWidth = 0.25;
  result.pixelHeight = 0.5;
  result.layerHeight = result.firstLayerHeight = 1;
  result.layers = 4;
  return result;
}

// Square millimetres of every layer; faces in millimetres.
std::vector<double> areas(TriangleMesh mesh, LayerShare share, const LayerOffset& offset) {
  for (Vec3d& p : mesh.points)
    p = {p[0] / 0.25, p[1] / 0.5, p[2]};
  MeshLayers source({mesh.points, mesh.triangles, false}, frame(), share, GreyLevels(), offset);
  std::vector<double> result;
  Progress progress;
  forEachLayer(
      source, [](std::int32_t, Layer&& layer) { return layer.filled; },
      [&](std::int32_t, double filled) { result.push_back(filled * 0.25 * 0.5); }, progress);
  return result;
}

TEST(OffsetRows, BoxGrowsRound) {
  const TriangleMesh box = meshes::box({5.1, 6.3, 0}, {15.4, 26.9, 4});
  for (const LayerShare share : {LayerShare::Area, LayerShare::Volume})
    for (const double d : {0.1, 0.6, 2.7})
      for (const double area : areas(box, share, {d, 0, 1}))
        EXPECT_NEAR(area, 10.3 * 20.6 + 2 * d * (10.3 + 20.6) + kPi * d * d, alongRows(share)) << d;
}

TEST(OffsetRows, BoxShrinksSharp) {
  const TriangleMesh box = meshes::box({5.1, 6.3, 0}, {15.4, 26.9, 4});
  for (const double d : {0.1, 0.6, 2.7})
    for (const double area : areas(box, LayerShare::Area, {-d, 0, 1}))
      EXPECT_NEAR(area, (10.3 - 2 * d) * (20.6 - 2 * d), 0.3);
  for (const double area : areas(box, LayerShare::Area, {-6, 0, 1}))
    EXPECT_EQ(area, 0);
}

TEST(OffsetRows, HoleShrinksAsTheSolidGrows) {
  TriangleMesh hole = meshes::box({9, 14, -1}, {12, 18, 5});
  for (std::size_t t = 0; t < hole.triangles.size(); t += 3)
    std::swap(hole.triangles[t], hole.triangles[t + 1]);
  const TriangleMesh mesh = meshes::joined({meshes::box({5, 6, 0}, {15, 26, 4}), hole});
  const double d = 0.5;
  const double outer = 200 + 2 * d * 30 + kPi * d * d, inner = (3 - 2 * d) * (4 - 2 * d);
  EXPECT_NEAR(areas(mesh, LayerShare::Area, {d, 0, 1})[2], outer - inner, 0.05);
}

// Two boxes that overlap grow as their union does.
TEST(OffsetRows, OverlapCountsOnce) {
  const TriangleMesh mesh =
      meshes::joined({meshes::box({5, 6, 0}, {15, 16, 4}), meshes::box({10, 6, 0}, {20, 16, 4})});
  EXPECT_NEAR(areas(mesh, LayerShare::Area, {1, 0, 1})[2], 150 + 2 * 25 + kPi, 0.05);
}

TEST(OffsetRows, FootFades) {
  const TriangleMesh box = meshes::box({5, 6, 0}, {15, 26, 4});
  const std::vector<double> found = areas(box, LayerShare::Area, {0, 0.6, 3});
  for (std::size_t k = 0; k < 4; ++k) {
    const double d = k < 3 ? 0.6 * double(3 - k) / 3 : 0;
    EXPECT_NEAR(found[k], (10 - 2 * d) * (20 - 2 * d), 0.3);
  }
  EXPECT_DOUBLE_EQ(found[3], 200);
}

// Every pixel against points that are tested one by one.
TEST(OffsetRows, SharesAreThoseOfPoints) {
  TriangleMesh mesh = meshes::cylinder(6, 4, 7);
  for (Vec3d& p : mesh.points) {
    p[0] += 12.3;
    p[1] += 20.7;
    p[2] += mesh.points[0][2] < 0 ? 2 : 0;
  }
  double low = 1e9;
  for (const Vec3d& p : mesh.points)
    low = std::min(low, p[2]);
  for (Vec3d& p : mesh.points)
    p[2] -= low;
  for (const double d : {0.7, -0.7}) {
    TriangleMesh scaled = mesh;
    for (Vec3d& p : scaled.points)
      p = {p[0] / 0.25, p[1] / 0.5, p[2]};
    // The lines of the plane z = 1.5, by the contours.
    std::vector<LayerContour> contours;
    Progress progress;
    MeshLayers lines({mesh.points, mesh.triangles, false}, frame(), LayerShare::Contours,
                     GreyLevels());
    forEachLayer(
        lines, [](std::int32_t, Layer&& layer) { return layer.contours; },
        [&](std::int32_t k, std::vector<LayerContour>&& found) {
          if (k == 1)
            contours = std::move(found);
        },
        progress);
    ASSERT_EQ(contours.size(), 1u);
    const LayerContour& c = contours.front();
    const auto isIn = [&](double x, double y) {
      bool inside = false;
      double nearest = 1e9;
      for (std::size_t i = 0; i < c.size(); ++i) {
        const auto &p = c[i], &q = c[(i + 1) % c.size()];
        if ((p[1] > y) != (q[1] > y) && x < p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]))
          inside = !inside;
        const double ux = q[0] - p[0], uy = q[1] - p[1];
        const double t =
            std::clamp(((x - p[0]) * ux + (y - p[1]) * uy) / (ux * ux + uy * uy), 0.0, 1.0);
        nearest = std::min(nearest, std::hypot(x - p[0] - t * ux, y - p[1] - t * uy));
      }
      return d > 0 ? inside || nearest <= d : inside && nearest > -d;
    };
    MeshLayers source({scaled.points, scaled.triangles, false}, frame(), LayerShare::Area,
                      GreyLevels(), {d, 0, 1});
    forEachLayer(
        source, [](std::int32_t, Layer&& layer) { return std::move(layer); },
        [&](std::int32_t k, Layer&& layer) {
          if (k != 1)
            return;
          std::vector<int> image(120 * 90, 0);
          for (std::size_t i = 0; i < layer.rows.size(); ++i) {
            const auto [begin, end] = layer.runsOf(i);
            for (const PixelRun* r = begin; r != end; ++r)
              std::fill(image.begin() + layer.rows[i].y * 120 + r->begin,
                        image.begin() + layer.rows[i].y * 120 + r->end, r->value);
          }
          for (int y = 0; y < 90; ++y)
            for (int x = 0; x < 120; ++x) {
              int count = 0;
              for (int i = 0; i < 256; ++i)
                count += isIn((x + (i % 16 + 0.5) / 16) * 0.25, (y + (i / 16 + 0.5) / 16) * 0.5);
              ASSERT_NEAR(image[std::size_t(y * 120 + x)], count * 255.0 / 256, 24)
                  << x << ", " << y;
            }
        },
        progress);
  }
}

} // namespace
} // namespace tetvdb
