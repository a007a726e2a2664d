// SPDX-License-Identifier: Apache-2.0
//
// Distances between pixels by brute force.
#include "DenseLayers.h"
#include "tetvdb/print/DrainPockets.h"
#include "tetvdb/print/FloorSweep.h"
#include "tetvdb/print/NearPixels.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

LayerFrame frameOf(double pixelWidth, double pixelHeight) {
  LayerFrame frame;
  frame.pixelWidth = pixelWidth;
  frame.pixelHeight = pixelHeight;
  frame.layerHeight = frame.firstLayerHeight = 0.05;
  return frame;
}

// A field of pixels with a wide margin of void.
struct Field {
  static constexpr int kWidth = 56, kHeight = 50, kMargin = 14;
  std::vector<std::uint8_t> on = std::vector<std::uint8_t>(kWidth * kHeight, 0);

  std::uint8_t& at(int x, int y) { return on[static_cast<std::size_t>(y * kWidth + x)]; }
  bool get(int x, int y) const { return on[static_cast<std::size_t>(y * kWidth + x)] != 0; }

  SpanRows rows() const {
    SpanRows result;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        if (get(x, y))
          result.add(y, x, x + 1);
    return result;
  }
};

Field blobs(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> place(Field::kMargin, 35), size(1, 12), kind(0, 2);
  Field field;
  for (int i = 0; i < 7; ++i) {
    const int x0 = place(random), y0 = place(random), w = size(random), h = size(random);
    const bool disc = kind(random) == 0, value = i < 4 || kind(random) > 0;
    for (int y = y0; y < std::min(y0 + h, Field::kHeight - Field::kMargin); ++y)
      for (int x = x0; x < std::min(x0 + w, Field::kWidth - Field::kMargin); ++x)
        if (!disc || std::hypot(2.0 * (x - x0) / w - 1, 2.0 * (y - y0) / h - 1) <= 1)
          field.at(x, y) = value;
  }
  return field;
}

// Squared distance from a pixel to the nearest of those that are `value`.
double squaredTo(const Field& field, int x, int y, bool value, const LayerFrame& frame) {
  double nearest = 1e300;
  for (int v = 0; v < Field::kHeight; ++v)
    for (int u = 0; u < Field::kWidth; ++u)
      if (field.get(u, v) == value)
        nearest = std::min(nearest, std::pow((u - x) * frame.pixelWidth, 2) +
                                        std::pow((v - y) * frame.pixelHeight, 2));
  return nearest;
}

Field thinByDefinition(const Field& field, bool value, double limit, const LayerFrame& frame) {
  Field core, thin;
  for (int y = 0; y < Field::kHeight; ++y)
    for (int x = 0; x < Field::kWidth; ++x)
      core.at(x, y) =
          field.get(x, y) == value && squaredTo(field, x, y, !value, frame) >= limit * limit / 4;
  for (int y = 0; y < Field::kHeight; ++y)
    for (int x = 0; x < Field::kWidth; ++x)
      thin.at(x, y) =
          field.get(x, y) == value && squaredTo(core, x, y, true, frame) > limit * limit;
  return thin;
}

void expectEqual(const SpanRows& rows, const Field& expected) {
  for (int y = 0; y < Field::kHeight; ++y) {
    std::vector<std::uint8_t> row(Field::kWidth, 0);
    const auto [begin, end] = rows.of(y);
    for (const Span* span = begin; span != end; ++span)
      for (int x = span->begin; x < span->end; ++x)
        row.at(static_cast<std::size_t>(x)) = 1;
    for (int x = 0; x < Field::kWidth; ++x)
      ASSERT_EQ(row[static_cast<std::size_t>(x)] != 0, expected.get(x, y)) << x << ", " << y;
  }
}

TEST(NearPixels, ThinIsWhatNoCorePixelIsNear) {
  std::size_t thin = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Field field = blobs(seed);
    const LayerFrame frame = frameOf(0.05, seed % 2 == 0 ? 0.05 : 0.07);
    for (const double limit : {0.13, 0.24, 0.37}) {
      const Field walls = thinByDefinition(field, true, limit, frame);
      const Field gaps = thinByDefinition(field, false, limit, frame);
      thin += static_cast<std::size_t>(std::count(walls.on.begin(), walls.on.end(), 1)) +
              static_cast<std::size_t>(std::count(gaps.on.begin(), gaps.on.end(), 1));
      expectEqual(thinPixels(field.rows(), limit, frame), walls);
      expectEqual(thinGaps(field.rows(), limit, frame), gaps);
    }
  }
  EXPECT_GT(thin, 500u);
}

TEST(NearPixels, WallsOfEveryWidth) {
  const LayerFrame frame = frameOf(0.05, 0.05);
  for (int width = 1; width < 16; ++width) {
    SpanRows wall;
    for (int y = 0; y < 100; ++y)
      wall.add(y, 10, 10 + width);
    // By up to a pixel narrower than the limit may pass, and what is as wide does.
    const double limit = 0.4;
    const double millimetres = width * 0.05;
    const SpanRows thin = thinPixels(wall, limit, frame);
    if (millimetres >= limit - 1e-12) {
      EXPECT_TRUE(thin.empty()) << width;
    }
    if (millimetres + 0.05 < limit - 1e-12) {
      EXPECT_EQ(thin.spans().size(), 100u) << width;
    }
    if (thin.empty())
      continue;
    const LabelledSpans region = labelled(thin, Neighbours::Eight);
    const std::vector<double> widths = widthsOf(region, complementOf(wall, 20), limit, frame);
    ASSERT_EQ(widths.size(), 1u);
    EXPECT_LE(widths[0], millimetres + 1e-9);
    EXPECT_GT(widths[0], millimetres - 0.0501);
  }
}

TEST(NearPixels, DistancesThatAreTies) {
  const PixelDisc closed(1, 1, 5, false), open(1, 1, 5, true);
  EXPECT_EQ(closed.rows(), 5);
  EXPECT_EQ(closed.reach(3), 4);
  EXPECT_EQ(closed.reach(0), 5);
  EXPECT_EQ(open.rows(), 4);
  EXPECT_EQ(open.reach(-3), 3);
  EXPECT_EQ(open.reach(0), 4);
  EXPECT_EQ(PixelDisc(1, 1, 0, true).rows(), -1);
}

TEST(FloorSweep, ThinIsWhatNoHighColumnIsNear) {
  std::size_t thin = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<std::int32_t> place(0, 22), size(1, 9), height(1, 12);
    DenseStack stack(32, 32, 18);
    for (int i = 0; i < 9; ++i) {
      const std::int32_t x = place(random), y = place(random), z = place(random) / 2;
      stack.fill({x, y, z}, {x + size(random), y + size(random), std::min(z + height(random), 18)},
                 true);
    }
    LayerFrame frame = DenseSource(stack, 0.1, 0.12, 0.05).frame();
    for (const std::int32_t layers : {1, 2, 3, 5, 8, 13, 20}) {
      const double limit = 0.05 * layers, reach = 2 * limit;
      std::vector<SpanRows> found;
      FloorSweep sweep(frame, limit, [&](std::int32_t k, SpanRows rows) {
        ASSERT_EQ(static_cast<std::size_t>(k), found.size());
        found.push_back(std::move(rows));
      });
      for (std::int32_t k = 0; k < stack.layers; ++k)
        sweep.add(stack.rows(k));
      sweep.finish();
      ASSERT_EQ(found.size(), 18u);
      const auto isHigh = [&](std::int32_t x, std::int32_t y, std::int32_t z) {
        std::int32_t low = z, high = z;
        while (stack.at(x, y, low - 1))
          --low;
        while (stack.at(x, y, high + 1))
          ++high;
        return stack.at(x, y, z) && high - low + 1 >= layers;
      };
      for (std::int32_t z = 0; z < stack.layers; ++z) {
        DenseStack expected(stack.width, stack.height, 1), got = expected;
        for (std::int32_t y = 0; y < stack.height; ++y)
          for (std::int32_t x = 0; x < stack.width; ++x) {
            bool near = false;
            for (std::int32_t v = 0; v < stack.height && !near; ++v)
              for (std::int32_t u = 0; u < stack.width && !near; ++u)
                near = std::pow(0.1 * (u - x), 2) + std::pow(0.12 * (v - y), 2) <= reach * reach &&
                       isHigh(u, v, z);
            expected.solid[expected.index(x, y, 0)] = stack.at(x, y, z) && !near;
            thin += stack.at(x, y, z) && !near ? 1 : 0;
          }
        const SpanRows& rows = found[static_cast<std::size_t>(z)];
        for (std::int32_t y = 0; y < stack.height; ++y) {
          const auto [begin, end] = rows.of(y);
          for (const Span* span = begin; span != end; ++span)
            got.fill({span->begin, y, 0}, {span->end, y + 1, 1}, true);
        }
        ASSERT_EQ(got.solid, expected.solid) << layers << " layers, layer " << z;
      }
    }
  }
  EXPECT_GT(thin, 1000u);
}

// --- openings ---

// The volumes of what of the places farther than the radius from all solid voxels is connected
// with no place around, below and above the stack.
std::vector<double> lockedIn(const DenseStack& stack, double radius) {
  const std::int32_t margin = static_cast<std::int32_t>(radius) + 2;
  DenseStack wide(stack.width + 2 * margin, stack.height + 2 * margin, stack.layers + 2 * margin);
  for (std::int32_t z = 0; z < wide.layers; ++z)
    for (std::int32_t y = 0; y < wide.height; ++y)
      for (std::int32_t x = 0; x < wide.width; ++x)
        for (std::int32_t c = z - margin; c <= z + margin; ++c)
          for (std::int32_t b = y - margin; b <= y + margin; ++b)
            for (std::int32_t a = x - margin; a <= x + margin; ++a)
              if (stack.at(a - margin, b - margin, c - margin) &&
                  (a - x) * (a - x) + (b - y) * (b - y) + (c - z) * (c - z) < radius * radius)
                wide.solid[wide.index(x, y, z)] = 1;
  std::vector<double> volumes;
  std::vector<std::uint8_t> seen = wide.solid;
  bool outside = true; // the first that is met
  for (std::int32_t z = 0; z < wide.layers; ++z)
    for (std::int32_t y = 0; y < wide.height; ++y)
      for (std::int32_t x = 0; x < wide.width; ++x) {
        if (seen[wide.index(x, y, z)])
          continue;
        double volume = 0;
        std::deque<std::array<std::int32_t, 3>> queue = {{x, y, z}};
        seen[wide.index(x, y, z)] = 1;
        while (!queue.empty()) {
          const auto [a, b, c] = queue.front();
          queue.pop_front();
          volume += 1;
          const std::int32_t next[6][3] = {{a - 1, b, c}, {a + 1, b, c}, {a, b - 1, c},
                                           {a, b + 1, c}, {a, b, c - 1}, {a, b, c + 1}};
          for (const auto& n : next)
            if (wide.has(n[0], n[1], n[2]) && !seen[wide.index(n[0], n[1], n[2])]) {
              seen[wide.index(n[0], n[1], n[2])] = 1;
              queue.push_back({n[0], n[1], n[2]});
            }
        }
        if (!outside)
          volumes.push_back(volume);
        outside = false;
      }
  std::sort(volumes.begin(), volumes.end());
  return volumes;
}

TEST(DrainPockets, BallsThatCannotLeave) {
  std::size_t pockets = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    // Two tanks with holes of random widths.
    std::mt19937 random(seed);
    std::uniform_int_distribution<std::int32_t> width(1, 7), place(8, 16);
    DenseStack stack(44, 24, 22);
    stack.fill({0, 0, 0}, {44, 24, 22}, true);
    stack.fill({2, 2, 2}, {21, 22, 20}, false);
    stack.fill({23, 3, 2}, {42, 22, 19}, false);
    for (int hole = 0; hole < 3; ++hole) {
      const std::int32_t w = width(random), y = place(random), z = place(random);
      const std::int32_t x = hole == 0 ? 0 : hole == 1 ? 20 : 41;
      stack.fill({x, y, z}, {x + 3, std::min(y + w, 22), std::min(z + w, 20)}, false);
    }
    for (const double diameter : {3.3, 5.1, 6.7}) {
      DrainPockets drains(DenseSource(stack, 1, 1, 1).frame(), diameter);
      ASSERT_EQ(drains.columns(), 1);
      for (std::int32_t k = 0; k < stack.layers; ++k)
        drains.add(k, drains.cellsOf(stack.rows(k)));
      Progress progress;
      std::vector<double> found;
      for (const LayerCavity& pocket : drains.find(progress))
        found.push_back(pocket.voxels);
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, lockedIn(stack, diameter / 2)) << seed << ", " << diameter;
      pockets += found.size();
    }
  }
  EXPECT_GT(pockets, 10u);
}

TEST(DrainPockets, CellsAreSolidWhereAPixelIs) {
  std::mt19937 random(5);
  const DenseStack stack = randomStack(random, 37, 31, 9, 0.05);
  const LayerFrame frame = DenseSource(stack, 1, 1, 1).frame();
  const DrainPockets drains(frame, 32); // cells of 4
  ASSERT_EQ(drains.columns(), 4);
  ASSERT_EQ(drains.layers(), 4);
  for (std::int32_t k = 0; k < stack.layers; ++k) {
    const SpanRows cells = drains.cellsOf(stack.rows(k));
    for (std::int32_t row = 0; row < 8; ++row)
      for (std::int32_t column = 0; column < 10; ++column) {
        bool expected = false;
        for (std::int32_t y = 4 * row; y < 4 * row + 4; ++y)
          for (std::int32_t x = 4 * column; x < 4 * column + 4; ++x)
            expected = expected || stack.at(x, y, k);
        const auto [begin, end] = cells.of(row);
        EXPECT_EQ(std::any_of(begin, end,
                              [&](const Span& s) { return s.begin <= column && column < s.end; }),
                  expected);
      }
  }
}

} // namespace
} // namespace tetvdb
