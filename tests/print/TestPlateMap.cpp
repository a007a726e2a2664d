// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/print/PlateMap.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

PrinterSettings printer() {
  PrinterSettings result;
  result.pixels = {80, 60};
  result.display = {16, 12};
  result.layerHeight = 0.25;
  return result;
}

WorldBox box(const Vec3d& low, const Vec3d& high) {
  WorldBox result;
  result.min = low;
  result.max = high;
  return result;
}

TEST(PlateMap, StandsInTheMiddle) {
  const PlateMap map = placeOnPlate(box({-3, 5, 7}, {1, 9, 10}), printer(), {});
  EXPECT_EQ(map.box.min, (Vec3d{6, 4, 0}));
  EXPECT_EQ(map.box.max, (Vec3d{10, 8, 3}));
  EXPECT_EQ(map({-1, 7, 8}), (Vec3d{8, 6, 1}));
}

TEST(PlateMap, WhatFillsThePlateFits) {
  PlaceOptions options;
  options.scale = 0.1;
  EXPECT_NO_THROW(placeOnPlate(box({0, 0, 0}, {160, 120, 1}), printer(), options));
  EXPECT_THROW(placeOnPlate(box({0, 0, 0}, {160.001, 120, 1}), printer(), options), Error);
}

TEST(PlateMap, CountsLayers) {
  PrinterSettings one = printer();
  EXPECT_EQ(frameOf(one, 1, LayerShare::Volume).layers, 4);
  EXPECT_EQ(frameOf(one, 1.01, LayerShare::Volume).layers, 5);
  EXPECT_EQ(frameOf(one, 1.01, LayerShare::Area).layers, 4);
  EXPECT_EQ(frameOf(one, 1.126, LayerShare::Area).layers, 5);
  EXPECT_EQ(frameOf(one, 1e-6, LayerShare::Area).layers, 1);
  one.firstLayerHeight = 0.5;
  EXPECT_EQ(frameOf(one, 1, LayerShare::Volume).layers, 3);
  EXPECT_THROW(frameOf(one, 1e6, LayerShare::Volume), Error);
}

// The plate's corner at the origin, seen from above.
TEST(PlateMap, TurnsImages) {
  PrinterSettings one = printer();
  using Pixel = std::array<double, 2>;
  EXPECT_EQ(pixelOf(one, 0, 0), (Pixel{0, 60}));
  EXPECT_TRUE(isMirrored(one));
  one.mirror = {true, false};
  EXPECT_EQ(pixelOf(one, 0, 0), (Pixel{80, 60}));
  EXPECT_FALSE(isMirrored(one));
  one.mirror = {true, true};
  EXPECT_EQ(pixelOf(one, 0, 0), (Pixel{80, 0}));
  one.portrait = true;
  EXPECT_EQ(pixelOf(one, 4, 0), (Pixel{0, 20}));
  one.mirror = {false, false};
  EXPECT_EQ(pixelOf(one, 4, 0), (Pixel{60, 60}));
}

TEST(PlateMap, PixelsAndPlacesOnThePlateAreOneToOne) {
  PrinterSettings one = printer();
  for (int turn = 0; turn < 8; ++turn) {
    one.portrait = (turn & 1) != 0;
    one.mirror = {(turn & 2) != 0, (turn & 4) != 0};
    const auto [column, row] = pixelOf(one, 3.5, 1.25);
    const auto [x, y] = plateOf(one, column, row);
    EXPECT_NEAR(x, 3.5, 1e-12) << turn;
    EXPECT_NEAR(y, 1.25, 1e-12) << turn;
  }
}

} // namespace
} // namespace tetvdb
