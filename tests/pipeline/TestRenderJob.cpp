// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/RenderJob.h"
#include "tetvdb/visualize/Srgb.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

std::vector<PictureMaker::CaptionedSubject>
captioned(std::vector<std::unique_ptr<Subject>> subjects) {
  std::vector<PictureMaker::CaptionedSubject> list;
  for (auto& subject : subjects)
    list.push_back({std::move(subject), "name"});
  return list;
}

template <typename... Subjects>
std::vector<PictureMaker::CaptionedSubject> captioned(Subjects... subjects) {
  std::vector<std::unique_ptr<Subject>> list;
  (list.push_back(std::move(subjects)), ...);
  return captioned(std::move(list));
}

PictureOptions transparent() {
  PictureOptions options;
  options.backgroundTop = options.backgroundBottom = {};
  options.view = "front";
  return options;
}

double cover(const Image& image, int left, int right) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = left; x < right; ++x)
      sum += image.at(x, y).alpha;
  return sum;
}

// Balls of radius 1 and 2 side by side: areas as 1 to 4, each in the middle of its own cell.
TEST(PictureMaker, OneScaleForAll) {
  Progress progress;
  PictureMaker maker(captioned(subjectOf(meshes::sphere({5, 5, 5}, 1, 40), {}),
                               subjectOf(meshes::sphere({-9, 0, 0}, 2, 40), {})),
                     transparent(), progress);
  const Image image = maker.take(0, progress);
  EXPECT_EQ(image.width, 1280);
  EXPECT_EQ(image.height, 480);
  // Captions are drawn at the upper left.
  const double small = cover(image, 200, 640), large = cover(image, 840, 1280);
  EXPECT_NEAR(cover(image, 640 + 60, 1280) / cover(image, 60, 640), 4, 0.01);
  EXPECT_GT(small, 0);
  EXPECT_GT(large, 0);
  EXPECT_GT(image.at(320, 240).alpha, 0.99);
  EXPECT_GT(image.at(960, 240).alpha, 0.99);
}

TEST(PictureMaker, ManySubjectsInRows) {
  Progress progress;
  std::vector<std::unique_ptr<Subject>> subjects;
  for (int i = 0; i < 5; ++i)
    subjects.push_back(subjectOf(meshes::box({0, 0, 0}, {1, 1, 1}), {}));
  PictureOptions options = transparent();
  options.width = 300;
  options.height = 200;
  const PictureMaker maker(captioned(std::move(subjects)), options, progress);
  const Image image = maker.take(0, progress);
  EXPECT_EQ(image.width, 300);
  EXPECT_GT(image.at(50, 50).alpha, 0.99);
  EXPECT_GT(image.at(150, 150).alpha, 0.99);
  EXPECT_EQ(image.at(250, 150).alpha, 0); // there is no sixth
}

// A block that grows warmer along x, cut at 3/4: the legend has the whole range, and the pixels the
// colours of their places.
TEST(PictureMaker, ValuesHaveTheColoursOfTheLegend) {
  Progress progress;
  TetMesh block = meshes::kuhnGrid(4, 4, 4);
  Attribute warmth;
  warmth.name = "warmth";
  std::vector<double> values;
  for (const Vec3d& p : block.points)
    values.push_back(10 + p[0]);
  warmth.values = values;
  block.attributes.push_back(warmth);
  MeshLook look;
  look.color = "warmth";
  PictureOptions options = transparent();
  options.colorMap = "grey";
  options.render.lighting.lampLight = 0;
  options.render.lighting.occlusion = false;
  options.render.lighting.skyLight = options.render.lighting.groundLight = 1;
  options.cut = Cut{0, 0.75, false};
  PictureMaker maker(captioned(subjectOf(block, look)), options, progress);
  ASSERT_TRUE(maker.scale());
  EXPECT_EQ(maker.scale()->low, 10);
  EXPECT_EQ(maker.scale()->high, 14);
  EXPECT_EQ(maker.scale()->title, "warmth");
  const Image image = maker.take(0, progress);
  // From the front x grows to the right; the part with x <= 3 stays. Its grey in sRGB is (value -
  // 10) / 4.
  int left = -1, right = -1;
  for (int x = 0; x < 480; ++x)
    if (image.at(x, 240).alpha > 0.99F) {
      left = left < 0 ? x : left;
      right = x;
    }
  ASSERT_GT(right - left, 200);
  for (int x = left + 5; x < right - 5; x += 7) {
    const double at = 3 * (x + 0.5 - left) / (right + 1 - left);
    EXPECT_NEAR(srgbOfLinear(image.at(x, 240).red), at / 4, 0.006) << x;
  }
}

TEST(PictureMaker, TheEyesSideIsCutAway) {
  for (const char* view : {"left", "right"}) {
    Progress progress;
    PictureOptions options = transparent();
    options.view = view;
    options.cut = Cut{0, 1.25, true};
    TetMesh block = meshes::kuhnGrid(4, 1, 1);
    const PictureMaker maker(captioned(subjectOf(block, {})), options, progress);
    const Box box = maker.drawn()[0].drawables[0]->bounds();
    EXPECT_LT(box.high[0] - box.low[0], 3.1);
    EXPECT_EQ(maker.drawn()[0].cutTets, 6U);
    if (std::string(view) == "right") {
      EXPECT_EQ(box.low[0], 0);
    } else {
      EXPECT_EQ(box.high[0], 4);
    }
  }
}

// While a thing turns nothing of it leaves the picture, and its middle stays in place.
TEST(PictureMaker, Turntable) {
  for (const bool perspective : {false, true}) {
    Progress progress;
    PictureOptions options = transparent();
    options.turntable = 8;
    options.width = options.height = 120;
    options.lens.perspective = perspective;
    const PictureMaker maker(captioned(subjectOf(meshes::box({5, 0, 0}, {9, 1, 0.5}), {})), options,
                             progress);
    double min = 1e9, max = 0;
    for (int i = 0; i < 8; ++i) {
      const Image image = maker.take(i / 8.0, progress);
      for (int k = 0; k < 120; ++k) {
        ASSERT_EQ(image.at(k, 0).alpha + image.at(k, 119).alpha, 0);
        ASSERT_EQ(image.at(0, k).alpha + image.at(119, k).alpha, 0);
      }
      EXPECT_GT(image.at(60, 60).alpha, 0.99);
      const double all = cover(image, 0, 120);
      min = std::min(min, all);
      max = std::max(max, all);
    }
    EXPECT_GT(max / min, 2); // seen from its end it is small
  }
}

TEST(PictureMaker, RegionsByTheirNames) {
  Progress progress;
  TetMesh block = meshes::kuhnGrid(2, 1, 1);
  for (std::size_t tet = 0; tet < block.tetCount(); ++tet)
    block.regions.push_back(tet < 6 ? 7 : 3);
  block.regionNames[7] = "steel";
  MeshLook look;
  look.color = "region";
  PictureOptions options = transparent();
  options.render.lighting.lampLight = 0;
  options.render.lighting.occlusion = false;
  options.render.lighting.skyLight = options.render.lighting.groundLight = 1;
  const PictureMaker maker(captioned(subjectOf(block, look)), options, progress);
  EXPECT_EQ(maker.scale()->kinds, (std::vector<std::string>{"3", "steel"}));
  const Image image = maker.take(0, progress);
  const int strip = 640 - 60; // about; the thing is left of the legend
  EXPECT_NEAR(image.at(strip / 4, 240).red, colorOfKind(1)[0], 1e-5);
  EXPECT_NEAR(image.at(strip * 3 / 4, 240).red, colorOfKind(0)[0], 1e-5);
}

TEST(PictureMaker, WhatDoesNotFit) {
  Progress progress;
  MeshLook look;
  look.color = "quality";
  EXPECT_THROW(subjectOf(meshes::box(), look), Error);
  look.color = "missing";
  EXPECT_THROW(subjectOf(meshes::kuhnGrid(1, 1, 1), look), Error);
  look.color = "region";
  EXPECT_THROW(subjectOf(meshes::kuhnGrid(1, 1, 1), look), Error);
  look.color = "";
  look.defects = true;
  EXPECT_THROW(subjectOf(meshes::kuhnGrid(1, 1, 1), look), Error);
  PictureOptions options;
  EXPECT_THROW(PictureMaker({}, options, progress), Error);
  options.range = std::array<double, 2>{0, 1};
  EXPECT_THROW(PictureMaker(captioned(subjectOf(meshes::box(), {})), options, progress), Error);
  options.range.reset();
  options.width = 10;
  EXPECT_THROW(PictureMaker(captioned(subjectOf(meshes::box(), {})), options, progress), Error);
  options.width = options.height = 60000;
  EXPECT_THROW(PictureMaker(captioned(subjectOf(meshes::box(), {})), options, progress), Error);
  options = {};
  options.cut = Cut{2, -50, true};
  EXPECT_THROW(PictureMaker(captioned(subjectOf(meshes::kuhnGrid(1, 1, 1), {})), options, progress),
               Error);
  options = {};
  options.colorMap = "jet";
  EXPECT_THROW(PictureMaker(captioned(subjectOf(meshes::box(), {})), options, progress), Error);
}

} // namespace
} // namespace tetvdb
