// SPDX-License-Identifier: Apache-2.0
//
// Whole checks of shapes whose faults are known.
#include "DenseLayers.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/print/CheckLayers.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

constexpr double kPixel = 0.5, kHeight = 0.25; // mm

PrintChecks check(const DenseStack& stack, const PrintLimits& limits) {
  DenseSource source(stack, kPixel, kPixel, kHeight);
  Progress progress;
  return checkLayers(source, limits, progress);
}

std::vector<PrintFinding> of(const PrintChecks& checks, PrintFault fault) {
  std::vector<PrintFinding> result;
  std::copy_if(checks.findings.begin(), checks.findings.end(), std::back_inserter(result),
               [&](const PrintFinding& f) { return f.fault == fault; });
  return result;
}

// A box with a cavity.
DenseStack tank() {
  DenseStack stack(20, 16, 14);
  stack.fill({2, 2, 0}, {18, 14, 14}, true);
  stack.fill({4, 4, 3}, {16, 12, 11}, false);
  return stack;
}

TEST(CheckLayers, AClosedTankIsATrap) {
  const PrintChecks checks = check(tank(), {});
  ASSERT_EQ(checks.findings.size(), 1u);
  const PrintFinding& trap = checks.findings[0];
  EXPECT_EQ(trap.fault, PrintFault::Trap);
  EXPECT_EQ(trap.first, 3);
  EXPECT_EQ(trap.last, 10);
  EXPECT_EQ(trap.pixels, 12 * 8);
  EXPECT_DOUBLE_EQ(trap.volume, 12 * 8 * 8 * kPixel * kPixel * kHeight);
  EXPECT_DOUBLE_EQ(trap.height, 8 * kHeight);
  EXPECT_EQ(trap.box.minX, 4);
  EXPECT_EQ(trap.box.maxX, 15);
  EXPECT_EQ(trap.box.minY, 4);
  EXPECT_EQ(trap.box.maxY, 11);
  EXPECT_DOUBLE_EQ(checks.volume, (16 * 12 * 14 - 12 * 8 * 8) * kPixel * kPixel * kHeight);
}

TEST(CheckLayers, ABottleIsACupUntilItsEnd) {
  DenseStack stack = tank();
  stack.fill({8, 7, 11}, {10, 9, 14}, false); // a neck
  const PrintChecks checks = check(stack, {});
  ASSERT_EQ(checks.findings.size(), 1u);
  const PrintFinding& cup = checks.findings[0];
  EXPECT_EQ(cup.fault, PrintFault::Cup);
  EXPECT_EQ(cup.first, 3);
  EXPECT_EQ(cup.last, 13);
  EXPECT_EQ(cup.joins, -1);
  EXPECT_FALSE(cup.onPlate);
  EXPECT_DOUBLE_EQ(cup.volume, (12 * 8 * 8 + 4 * 3) * kPixel * kPixel * kHeight);
}

TEST(CheckLayers, ATankWithAHoleInItsSideIsACupBelowTheHole) {
  DenseStack stack = tank();
  stack.fill({16, 7, 6}, {18, 8, 7}, false);
  const std::vector<PrintFinding> cups = of(check(stack, {}), PrintFault::Cup);
  ASSERT_EQ(cups.size(), 1u);
  EXPECT_EQ(cups[0].first, 3);
  EXPECT_EQ(cups[0].last, 5);
  EXPECT_EQ(cups[0].joins, 6);
}

TEST(CheckLayers, ThePlateClosesWhatStandsOnIt) {
  DenseStack stack = tank();
  stack.fill({4, 4, 0}, {16, 12, 3}, false); // no bottom
  const PrintChecks checks = check(stack, {});
  ASSERT_EQ(checks.findings.size(), 1u);
  EXPECT_EQ(checks.findings[0].fault, PrintFault::Cup);
  EXPECT_TRUE(checks.findings[0].onPlate);
}

TEST(CheckLayers, ASiphonIsACupBelowItsLowerEnd) {
  DenseStack stack(20, 9, 16);
  stack.fill({0, 0, 0}, {20, 9, 16}, true);
  stack.fill({3, 4, 2}, {4, 5, 16}, false);  // up to the top
  stack.fill({3, 4, 2}, {15, 5, 3}, false);  // along the bottom
  stack.fill({14, 4, 2}, {15, 5, 9}, false); // up, and out at the side
  stack.fill({14, 4, 8}, {20, 5, 9}, false);
  const std::vector<PrintFinding> cups = of(check(stack, {}), PrintFault::Cup);
  ASSERT_EQ(cups.size(), 1u);
  EXPECT_EQ(cups[0].first, 2);
  EXPECT_EQ(cups[0].last, 7);
  EXPECT_EQ(cups[0].joins, 8);
  EXPECT_TRUE(of(check(stack, {}), PrintFault::Trap).empty());
}

// A tree of corridors that reaches every cell of 6 x 5 x 4; `open`: it has a way out.
DenseStack labyrinth(bool open) {
  DenseStack stack(13, 11, 9);
  stack.fill({0, 0, 0}, {13, 11, 9}, true);
  std::mt19937 random(11);
  std::vector<std::array<std::int32_t, 3>> path = {{0, 0, 0}};
  stack.solid[stack.index(1, 1, 1)] = 0;
  const std::int32_t steps[6][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                    {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
  while (!path.empty()) {
    const auto [x, y, z] = path.back();
    std::vector<int> free;
    for (int i = 0; i < 6; ++i) {
      const std::int32_t a = x + steps[i][0], b = y + steps[i][1], c = z + steps[i][2];
      if (a >= 0 && b >= 0 && c >= 0 && a < 6 && b < 5 && c < 4 &&
          stack.at(2 * a + 1, 2 * b + 1, 2 * c + 1))
        free.push_back(i);
    }
    if (free.empty()) {
      path.pop_back();
      continue;
    }
    const auto& step = steps[free[random() % free.size()]];
    stack.solid[stack.index(2 * x + 1 + step[0], 2 * y + 1 + step[1], 2 * z + 1 + step[2])] = 0;
    path.push_back({x + step[0], y + step[1], z + step[2]});
    const auto [a, b, c] = path.back();
    stack.solid[stack.index(2 * a + 1, 2 * b + 1, 2 * c + 1)] = 0;
  }
  if (open)
    stack.solid[stack.index(12, 9, 1)] = 0; // at the foot, so that only higher corridors are cups
  return stack;
}

TEST(CheckLayers, ALabyrinthIsATrapOnlyWithoutAWayOut) {
  EXPECT_TRUE(of(check(labyrinth(true), {}), PrintFault::Trap).empty());
  const std::vector<PrintFinding> traps = of(check(labyrinth(false), {}), PrintFault::Trap);
  ASSERT_EQ(traps.size(), 1u);
  EXPECT_DOUBLE_EQ(traps[0].volume, (120 + 119) * kPixel * kPixel * kHeight); // cells, and doors
}

TEST(CheckLayers, IslandsAndWhereTheyJoin) {
  DenseStack stack(20, 10, 12);
  stack.fill({2, 2, 0}, {5, 8, 12}, true);
  stack.fill({10, 3, 4}, {14, 5, 9}, true);  // hangs
  stack.fill({5, 3, 8}, {10, 5, 9}, true);   // from a beam
  stack.fill({16, 3, 9}, {18, 5, 11}, true); // floats
  const std::vector<PrintFinding> islands = of(check(stack, {}), PrintFault::Island);
  ASSERT_EQ(islands.size(), 2u);
  EXPECT_EQ(islands[0].layer, 4);
  EXPECT_EQ(islands[0].joins, 8);
  EXPECT_EQ(islands[0].pixels, 8);
  EXPECT_EQ(islands[0].last, 7);
  EXPECT_EQ(islands[0].pixel, (std::array<double, 2>{11.5, 3.5}));
  EXPECT_EQ(islands[1].layer, 9);
  EXPECT_EQ(islands[1].joins, -1);
  EXPECT_EQ(islands[1].last, 10);
}

TEST(CheckLayers, EmptyLayers) {
  DenseStack stack(8, 8, 12);
  stack.fill({2, 2, 0}, {5, 5, 3}, true);
  stack.fill({2, 2, 5}, {5, 5, 6}, true);
  stack.fill({2, 2, 7}, {5, 5, 9}, true); // layers above are no gap
  const std::vector<PrintFinding> empty = of(check(stack, {}), PrintFault::EmptyLayer);
  ASSERT_EQ(empty.size(), 2u);
  EXPECT_EQ(empty[0].first, 3);
  EXPECT_EQ(empty[0].last, 4);
  EXPECT_EQ(empty[1].first, 6);
  EXPECT_EQ(empty[1].last, 6);
  EXPECT_EQ(of(check(DenseStack(8, 8, 3), {}), PrintFault::EmptyLayer).size(), 1u);
}

TEST(CheckLayers, OverhangIsWhatIsFarFromTheLayerBelow) {
  std::size_t pixels = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    DenseStack stack(30, 26, 2);
    std::uniform_int_distribution<std::int32_t> place(0, 20), size(1, 6);
    for (std::int32_t z = 0; z < 2; ++z)
      for (int i = 0; i < 6; ++i) {
        const std::int32_t x = place(random), y = place(random);
        stack.fill({x, y, z}, {x + size(random), y + size(random), z + 1}, true);
      }
    PrintLimits limits;
    limits.overhangAngle = 75;
    const double reach =
        kHeight * std::tan(75 * std::acos(-1.0) / 180) + kPixel * std::sqrt(2.0) / 2;
    double expected = 0;
    const LabelledSpans above = labelled(stack.rows(1), Neighbours::Eight);
    for (std::uint32_t label = 0; label < above.shapes.size(); ++label) {
      bool held = false;
      double far = 0;
      for (std::int32_t y = 0; y < stack.height; ++y) {
        const auto [begin, end] = above.rows.rangeOf(y);
        for (std::size_t i = begin; i < end; ++i) {
          if (above.labels[i] != label)
            continue;
          for (std::int32_t x = above.rows.spans()[i].begin; x < above.rows.spans()[i].end; ++x) {
            held = held || stack.at(x, y, 0);
            double nearest = 1e9;
            for (std::int32_t v = 0; v < stack.height; ++v)
              for (std::int32_t u = 0; u < stack.width; ++u)
                if (stack.at(u, v, 0))
                  nearest = std::min(nearest, kPixel * std::hypot(u - x, v - y));
            far += nearest > reach ? 1 : 0;
          }
        }
      }
      expected += held ? far : 0;
    }
    double found = 0;
    for (const PrintFinding& f : of(check(stack, limits), PrintFault::Overhang))
      found += f.totalArea / (kPixel * kPixel);
    EXPECT_DOUBLE_EQ(found, expected) << seed;
    pixels += static_cast<std::size_t>(expected);
  }
  EXPECT_GT(pixels, 50u);
}

TEST(CheckLayers, ASlopeIsJudgedByItsAngle) {
  // Leans out by two pixels, 1 mm, in a layer of 0.25 mm: 76 degrees.
  DenseStack stack(60, 12, 20);
  for (std::int32_t z = 0; z < 20; ++z)
    stack.fill({2, 2, z}, {12 + 2 * z, 10, z + 1}, true);
  PrintLimits limits;
  limits.overhangAngle = 78;
  EXPECT_TRUE(check(stack, limits).findings.empty());
  limits.overhangAngle = 45;
  const std::vector<PrintFinding> leans = of(check(stack, limits), PrintFault::Overhang);
  ASSERT_EQ(leans.size(), 1u); // one surface
  EXPECT_EQ(leans[0].first, 1);
  EXPECT_EQ(leans[0].last, 19);
}

TEST(CheckLayers, WallsAndGaps) {
  DenseStack stack(60, 30, 24);
  stack.fill({4, 4, 0}, {24, 26, 24}, true);
  stack.fill({24, 14, 0}, {36, 16, 24}, true); // 1 mm thick
  stack.fill({40, 4, 0}, {56, 26, 24}, true);
  stack.fill({47, 4, 0}, {49, 20, 24}, false); // a slot, 1 mm wide
  PrintLimits limits;
  limits.minWall = 2;
  limits.minGap = 2.1;
  const PrintChecks checks = check(stack, limits);
  const std::vector<PrintFinding> walls = of(checks, PrintFault::ThinWall);
  ASSERT_EQ(walls.size(), 1u);
  EXPECT_EQ(walls[0].first, 0);
  EXPECT_EQ(walls[0].last, 23);
  EXPECT_GT(walls[0].width, 0.49);
  EXPECT_LE(walls[0].width, 1.0);
  EXPECT_GE(walls[0].box.minX, 24);
  EXPECT_LT(walls[0].box.maxX, 36);
  const std::vector<PrintFinding> gaps = of(checks, PrintFault::ThinGap);
  ASSERT_EQ(gaps.size(), 1u);
  EXPECT_EQ(gaps[0].box.minX, 47);
  EXPECT_EQ(gaps[0].box.maxX, 48);
  EXPECT_EQ(gaps[0].box.maxY, 19);
  limits.minWall = 1;
  limits.minGap = 1;
  EXPECT_TRUE(check(stack, limits).findings.empty());
}

TEST(CheckLayers, FloorsAreThinFromBelowToAbove) {
  DenseStack stack(60, 30, 24);
  stack.fill({4, 4, 0}, {14, 26, 24}, true);
  stack.fill({14, 4, 10}, {50, 26, 12}, true); // 0.5 mm thick
  PrintLimits limits;
  limits.minFloor = 0.75;
  const std::vector<PrintFinding> floors = of(check(stack, limits), PrintFault::ThinFloor);
  ASSERT_EQ(floors.size(), 1u);
  EXPECT_EQ(floors[0].first, 10);
  EXPECT_EQ(floors[0].last, 11);
  EXPECT_EQ(floors[0].pixels, (50 - 17) * 22); // but for 1.5 mm beside the block
  limits.minFloor = 0.5;
  EXPECT_TRUE(of(check(stack, limits), PrintFault::ThinFloor).empty());
}

TEST(CheckLayers, NarrowDrainsAreFoundAndTrapsAreNotTwice) {
  DenseStack stack(40, 40, 60);
  stack.fill({0, 0, 0}, {40, 40, 60}, true);
  stack.fill({4, 4, 4}, {36, 36, 56}, false);
  PrintLimits limits;
  limits.drain = 4;
  EXPECT_EQ(of(check(stack, limits), PrintFault::Trap).size(), 1u);
  EXPECT_TRUE(of(check(stack, limits), PrintFault::Drain).empty());
  stack.fill({18, 18, 0}, {20, 20, 4}, false); // 1 mm wide
  EXPECT_TRUE(of(check(stack, limits), PrintFault::Trap).empty());
  const std::vector<PrintFinding> drains = of(check(stack, limits), PrintFault::Drain);
  ASSERT_EQ(drains.size(), 1u);
  EXPECT_GT(drains[0].pixel[0], 4);
  EXPECT_LT(drains[0].pixel[0], 36);
  EXPECT_GE(drains[0].first, 4);
  EXPECT_LE(drains[0].last, 55);
  stack.fill({14, 14, 0}, {26, 26, 4}, false); // 6 mm
  EXPECT_TRUE(of(check(stack, limits), PrintFault::Drain).empty());
}

TEST(CheckLayers, SmallFindingsAreCounted) {
  PrintLimits limits;
  limits.minVolume = 1e6;
  const PrintChecks checks = check(tank(), limits);
  EXPECT_TRUE(checks.findings.empty());
  EXPECT_EQ(checks.leftOut[static_cast<std::size_t>(PrintFault::Trap)], 1u);
}

TEST(CheckLayers, ThreadsDoNotMatter) {
  std::mt19937 random(3);
  const DenseStack stack = randomStack(random, 40, 40, 90, 0.45);
  PrintLimits limits;
  limits.overhangAngle = 60;
  limits.minWall = 1.2;
  limits.minGap = 1.2;
  limits.minFloor = 0.5;
  limits.drain = 3;
  const auto runWith = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return check(stack, limits); });
  };
  const PrintChecks one = runWith(1), two = runWith(2);
  EXPECT_GT(one.findings.size(), 100u);
  ASSERT_EQ(one.findings.size(), two.findings.size());
  for (std::size_t i = 0; i < one.findings.size(); ++i) {
    EXPECT_EQ(one.findings[i].fault, two.findings[i].fault);
    EXPECT_EQ(one.findings[i].pixel, two.findings[i].pixel);
    EXPECT_EQ(one.findings[i].layer, two.findings[i].layer);
    EXPECT_EQ(one.findings[i].pixels, two.findings[i].pixels);
    EXPECT_EQ(one.findings[i].volume, two.findings[i].volume);
    EXPECT_EQ(one.findings[i].width, two.findings[i].width);
  }
}

TEST(CheckLayers, LimitsAreChecked) {
  PrintLimits limits;
  limits.overhangAngle = 90;
  EXPECT_THROW(check(tank(), limits), Error);
  limits.overhangAngle = 45;
  limits.minWall = -1;
  EXPECT_THROW(check(tank(), limits), Error);
}

} // namespace
} // namespace tetvdb
