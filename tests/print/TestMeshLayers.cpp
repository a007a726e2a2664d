// SPDX-License-Identifier: Apache-2.0
#include "RationalClipping.h"
#include "TriangleMeshes.h"
#include "tetvdb/print/LayerSource.h"
#include "tetvdb/print/MeshLayers.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tuple>

namespace tetvdb {
namespace {

using Pixels = std::map<std::tuple<int, int, int>, int>; // layer, y, x

LayerFrame smallFrame(int layers = 12) {
  LayerFrame frame;
  frame.width = 40;
  frame.height = 30;
  frame.pixelWidth = frame.pixelHeight = frame.layerHeight = frame.firstLayerHeight = 1;
  frame.layers = layers;
  return frame;
}

struct Cut {
  Pixels pixels;
  double filled = 0, overlap = 0;
  std::vector<std::vector<LayerContour>> contours;
};

Cut cut(const TriangleMesh& mesh, const LayerFrame& frame, LayerShare share, int threads = 0,
        const GreyOptions& grey = {}, bool mirrored = false) {
  Cut result;
  const auto run = [&] {
    MeshLayers source({mesh.points, mesh.triangles, mirrored}, frame, share, GreyLevels(grey));
    Progress progress;
    forEachLayer(
        source, [](std::int32_t, Layer&& layer) { return std::move(layer); },
        [&](std::int32_t k, Layer&& layer) {
          EXPECT_EQ(std::size_t(k), result.contours.size());
          result.contours.push_back(layer.contours);
          result.filled += layer.filled;
          result.overlap += layer.overlap;
          for (std::size_t i = 0; i < layer.rows.size(); ++i) {
            const auto [begin, end] = layer.runsOf(i);
            EXPECT_LT(begin, end);
            for (const PixelRun* r = begin; r != end; ++r)
              for (int x = r->begin; x < r->end; ++x)
                EXPECT_TRUE(
                    result.pixels.emplace(std::tuple(k, layer.rows[i].y, x), r->value).second);
          }
        },
        progress);
  };
  if (threads == 0) {
    run();
  } else {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      std::size_t(threads));
    tbb::task_arena(threads).execute(run);
  }
  return result;
}

TriangleMesh moved(TriangleMesh mesh, const Vec3d& scale, const Vec3d& offset) {
  for (Vec3d& p : mesh.points)
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = p[k] * scale[k] + offset[k];
  return mesh;
}

double volumeOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
    const Vec3d &a = mesh.points[mesh.triangles[t]], &b = mesh.points[mesh.triangles[t + 1]],
                &c = mesh.points[mesh.triangles[t + 2]];
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6;
}

// round(255 share), halves upward, in rational numbers.
int greyOf(const oracle::Number& share) {
  const oracle::Number twice = share * 510 + 1;
  const boost::multiprecision::cpp_int whole = numerator(twice) / denominator(twice);
  return static_cast<int>(whole) / 2;
}

// A tetrahedron by its corners; its faces look outward.
TriangleMesh tetrahedron(std::array<Vec3d, 4> p) {
  TriangleMesh mesh;
  mesh.points.assign(p.begin(), p.end());
  mesh.triangles = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  if (volumeOf(mesh) < 0)
    mesh.triangles = {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0};
  return mesh;
}

oracle::Tet rationalTet(const TriangleMesh& mesh, double zScale = 1) {
  oracle::Tet tet;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      tet[i][k] = oracle::Number(mesh.points[i][k]) * (k == 2 ? oracle::Number(zScale) : 1);
  return tet;
}

// The part of a tet in a box, exactly.
oracle::Number volumeWithin(const oracle::Tet& tet, const std::array<oracle::Number, 3>& low,
                            const std::array<oracle::Number, 3>& high) {
  std::vector<oracle::Tet> parts = {tet}, next;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {1, -1}) {
      next.clear();
      for (const oracle::Tet& part : parts)
        oracle::keep(part, axis, side > 0 ? low[axis] : high[axis], side, next);
      parts.swap(next);
    }
  oracle::Number six = 0;
  for (const oracle::Tet& part : parts)
    six += oracle::sixVolumes(part);
  return six / 6;
}

TriangleMesh randomTetrahedron(std::mt19937& random, bool onLattice) {
  const auto number = [&](double below) {
    const double value = std::uniform_real_distribution<double>(0, below)(random);
    return onLattice ? std::floor(value * 2) / 2 : value;
  };
  return tetrahedron(
      {Vec3d{number(12), number(10), number(6)}, Vec3d{number(12), number(10), number(6)},
       Vec3d{number(12), number(10), number(6)}, Vec3d{number(12), number(10), number(6)}});
}

TEST(MeshLayers, VolumesAreThoseOfRationalClipping) {
  std::mt19937 random(7);
  const LayerFrame frame = smallFrame(6);
  for (int i = 0; i < 6; ++i) {
    const TriangleMesh mesh = randomTetrahedron(random, i % 2 == 0);
    const Cut found = cut(mesh, frame, LayerShare::Volume);
    const oracle::Tet tet = rationalTet(mesh);
    for (int k = 0; k < 6; ++k)
      for (int y = 0; y < 10; ++y)
        for (int x = 0; x < 12; ++x) {
          const oracle::Number share = volumeWithin(tet, {x, y, k}, {x + 1, y + 1, k + 1});
          const auto pixel = found.pixels.find({k, y, x});
          const int grey = pixel == found.pixels.end() ? 0 : pixel->second;
          ASSERT_EQ(grey, greyOf(share)) << i << " at " << x << ", " << y << ", " << k;
        }
    EXPECT_NEAR(found.filled, volumeOf(mesh), 1e-10 * volumeOf(mesh) + 1e-12);
  }
}

// Slices thinner than any detail stand for the plane.
TEST(MeshLayers, AreasAreThoseOfRationalClipping) {
  std::mt19937 random(8);
  const LayerFrame frame = smallFrame(6);
  const oracle::Number thin = oracle::Number(1) / (1 << 30);
  for (int i = 0; i < 6; ++i) {
    const TriangleMesh mesh = randomTetrahedron(random, false);
    const Cut found = cut(mesh, frame, LayerShare::Area);
    const oracle::Tet tet = rationalTet(mesh);
    for (int k = 0; k < 6; ++k)
      for (int y = 0; y < 10; ++y)
        for (int x = 0; x < 12; ++x) {
          const oracle::Number midpoint = oracle::Number(2 * k + 1) / 2;
          const oracle::Number share =
              volumeWithin(tet, {x, y, midpoint - thin}, {x + 1, y + 1, midpoint + thin}) / thin /
              2;
          const auto pixel = found.pixels.find({k, y, x});
          const int grey = pixel == found.pixels.end() ? 0 : pixel->second;
          const double exact = 255 * share.convert_to<double>();
          ASSERT_LE(std::abs(grey - exact), 0.5 + 1e-4) << x << ", " << y << ", " << k;
        }
  }
}

TEST(MeshLayers, BoxOnPixelsIsWhite) {
  const TriangleMesh mesh = meshes::box({2, 3, 0}, {7, 9, 4});
  for (const LayerShare share : {LayerShare::Area, LayerShare::Volume}) {
    const Cut found = cut(mesh, smallFrame(5), share);
    EXPECT_EQ(found.pixels.size(), std::size_t(5 * 6 * 4));
    for (const auto& [at, grey] : found.pixels)
      EXPECT_EQ(grey, 255);
    EXPECT_DOUBLE_EQ(found.filled, 5 * 6 * 4);
  }
}

TEST(MeshLayers, FirstLayerHasAHeightOfItsOwn) {
  LayerFrame frame = smallFrame(3);
  frame.firstLayerHeight = 2.5;
  const TriangleMesh mesh = meshes::box({2, 3, 0}, {3, 4, 3.75});
  const Cut found = cut(mesh, frame, LayerShare::Volume);
  ASSERT_EQ(found.pixels.size(), 3u);
  EXPECT_EQ(found.pixels.at({0, 3, 2}), 255);
  EXPECT_EQ(found.pixels.at({1, 3, 2}), 255);
  EXPECT_EQ(found.pixels.at({2, 3, 2}), 64); // a quarter: 63.75
}

TEST(MeshLayers, SumOfSharesIsTheVolumeOfABall) {
  const TriangleMesh mesh = moved(meshes::sphere(), {9.3, 8.1, 5.7}, {20.13, 15.37, 5.9});
  const Cut found = cut(mesh, smallFrame(12), LayerShare::Volume);
  EXPECT_NEAR(found.filled / volumeOf(mesh), 1, 1e-10);
}

TEST(MeshLayers, SameForAnyNumberOfThreadsAndOrderOfFaces) {
  TriangleMesh mesh = moved(meshes::sphere(), {9.3, 8.1, 5.7}, {20.13, 15.37, 5.9});
  for (const LayerShare share : {LayerShare::Area, LayerShare::Volume}) {
    const Cut one = cut(mesh, smallFrame(12), share, 1);
    for (const int threads : {2, 64})
      EXPECT_TRUE(cut(mesh, smallFrame(12), share, threads).pixels == one.pixels);
    TriangleMesh other = mesh;
    std::mt19937 random(3);
    std::vector<std::array<std::uint32_t, 3>> faces;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3)
      faces.push_back({mesh.triangles[t + 1], mesh.triangles[t + 2], mesh.triangles[t]});
    std::shuffle(faces.begin(), faces.end(), random);
    for (std::size_t i = 0; i < faces.size(); ++i)
      std::copy(faces[i].begin(), faces[i].end(), other.triangles.begin() + std::ptrdiff_t(3 * i));
    EXPECT_TRUE(cut(other, smallFrame(12), share).pixels == one.pixels);
    EXPECT_EQ(cut(other, smallFrame(12), share).filled, one.filled);
  }
}

TEST(MeshLayers, MirroredFacesGiveTheMirroredImage) {
  const TriangleMesh mesh = moved(meshes::sphere(), {9.3, 8.1, 5.7}, {20.13, 15.37, 5.9});
  const TriangleMesh other = moved(mesh, {-1, 1, 1}, {40, 0, 0});
  for (const LayerShare share : {LayerShare::Area, LayerShare::Volume}) {
    const Cut a = cut(mesh, smallFrame(12), share);
    const Cut b = cut(other, smallFrame(12), share, 0, {}, true);
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    for (const auto& [at, grey] : a.pixels) {
      const auto [k, y, x] = at;
      EXPECT_EQ(b.pixels.at({k, y, 39 - x}), grey);
    }
  }
}

TEST(MeshLayers, OverlapIsCountedOnce) {
  const TriangleMesh mesh =
      meshes::joined({meshes::box({2, 2, 0}, {6, 6, 2}), meshes::box({4, 4, 0}, {8, 8, 2})});
  const Cut found = cut(mesh, smallFrame(2), LayerShare::Volume);
  EXPECT_EQ(found.pixels.size(), std::size_t(2 * (16 + 16 - 4)));
  EXPECT_DOUBLE_EQ(found.filled, 2 * (16 + 16 - 4));
  EXPECT_DOUBLE_EQ(found.overlap, 2 * 4);
}

TEST(MeshLayers, CavityIsBlack) {
  TriangleMesh inner = meshes::box({4, 4, 1}, {6, 6, 3});
  for (std::size_t t = 0; t < inner.triangles.size(); t += 3)
    std::swap(inner.triangles[t], inner.triangles[t + 1]);
  const Cut found = cut(meshes::joined({meshes::box({2, 2, 0}, {8, 8, 4}), inner}), smallFrame(4),
                        LayerShare::Volume);
  EXPECT_EQ(found.pixels.size(), std::size_t(4 * 36 - 2 * 4));
  EXPECT_EQ(found.pixels.count({1, 4, 4}), 0u);
  EXPECT_EQ(found.pixels.count({0, 4, 4}), 1u);
}

TEST(MeshLayers, ContoursTurnRoundSolids) {
  TriangleMesh inner = meshes::box({4, 4, 1}, {6, 6, 3});
  for (std::size_t t = 0; t < inner.triangles.size(); t += 3)
    std::swap(inner.triangles[t], inner.triangles[t + 1]);
  const Cut found = cut(meshes::joined({meshes::box({2, 2, 0}, {8, 8, 4}), inner}), smallFrame(4),
                        LayerShare::Contours);
  ASSERT_EQ(found.contours.size(), 4u);
  EXPECT_EQ(found.contours[0].size(), 1u);
  ASSERT_EQ(found.contours[1].size(), 2u);
  EXPECT_DOUBLE_EQ(found.filled, 4 * 36 - 2 * 4); // outer ones count up, inner ones down
}

// A vertex, an edge and a face lie in the middle plane: as if it were a little lower.
TEST(MeshLayers, WhatLiesOnThePlaneIsAboveIt) {
  const TriangleMesh mesh = meshes::box({2, 3, 0.5}, {7, 9, 1.5});
  const Cut found = cut(mesh, smallFrame(3), LayerShare::Area);
  EXPECT_EQ(found.pixels.size(), 30u); // layer 1 alone
  EXPECT_EQ(found.pixels.count({1, 3, 2}), 1u);
  const TriangleMesh pointed =
      tetrahedron({Vec3d{2, 2, 0.5}, Vec3d{8, 2, 1.5}, Vec3d{2, 8, 1.5}, Vec3d{3, 3, 2.5}});
  EXPECT_NO_THROW(cut(pointed, smallFrame(3), LayerShare::Area));
  EXPECT_NO_THROW(cut(pointed, smallFrame(3), LayerShare::Contours));
}

TEST(MeshLayers, HundredsOfLayersInSlabs) {
  LayerFrame frame = smallFrame(3000);
  frame.layerHeight = frame.firstLayerHeight = 1.0 / 256;
  const TriangleMesh mesh = moved(meshes::sphere(), {9.3, 8.1, 5.7}, {20.13, 15.37, 5.8});
  const Cut found = cut(mesh, frame, LayerShare::Volume);
  EXPECT_EQ(found.contours.size(), 3000u);
  EXPECT_NEAR(found.filled / 256 / volumeOf(mesh), 1, 1e-10);
}

TEST(GreyLevels, RoundHalvesUpward) {
  const GreyLevels levels;
  for (int grey = 0; grey < 255; ++grey) {
    // 255 c = grey + 1/2
    const oracle::Number c = (oracle::Number(grey) + oracle::Number(1) / 2) / 255;
    const boost::multiprecision::cpp_int below = numerator(c) * GreyLevels::kWhole / denominator(c);
    const auto share = static_cast<std::int64_t>(below);
    const bool exact = below * denominator(c) == numerator(c) * GreyLevels::kWhole;
    EXPECT_EQ(levels.of(share), exact ? grey + 1 : grey);
    EXPECT_EQ(levels.of(share + 1), grey + 1);
  }
  EXPECT_EQ(levels.of(0), 0);
  EXPECT_EQ(levels.of(GreyLevels::kWhole), 255);
}

TEST(GreyLevels, FewLevelsGammaAndTable) {
  GreyOptions options;
  options.levels = 2;
  EXPECT_EQ(GreyLevels(options).of(GreyLevels::kWhole / 2 - 1), 0);
  EXPECT_EQ(GreyLevels(options).of(GreyLevels::kWhole / 2), 255);
  options.levels = 4;
  EXPECT_EQ(GreyLevels(options).of(GreyLevels::kWhole / 3), 85);
  options = {};
  options.gamma = 0;
  EXPECT_EQ(GreyLevels(options).of(GreyLevels::kWhole / 2 - 1), 0);
  EXPECT_EQ(GreyLevels(options).of(GreyLevels::kWhole / 2), 255);
  options.gamma = 2;
  EXPECT_EQ(GreyLevels(options).of(GreyLevels::kWhole / 2), 64);
  options = {};
  options.table.emplace();
  options.table->fill(7);
  EXPECT_EQ(GreyLevels(options).of(GreyLevels::kWhole / 5), 7);
}

} // namespace
} // namespace tetvdb
