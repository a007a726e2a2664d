// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/InsertionOrder.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <vector>

namespace tetvdb {
namespace {

std::vector<Vec3d> grid(int side) {
  std::vector<Vec3d> points;
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z)
        points.push_back({x + 0.5, y + 0.5, z + 0.5});
  return points;
}

TEST(InsertionOrder, EachPointOnce) {
  const std::vector<Vec3d> points = grid(16);
  std::vector<std::uint32_t> order = insertionOrder(points, 5, Box{{0, 0, 0}, {16, 16, 16}});
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> expected(points.size() - 5);
  std::iota(expected.begin(), expected.end(), 5u);
  EXPECT_EQ(order, expected);
}

TEST(InsertionOrder, MostStepsGoToTheNextCells) {
  // A Hilbert curve goes from cell to cell through faces. With seven cells of eight left in the
  // last round, the points before it apart, steps are 8/7 cells long on average; along a Morton
  // curve they would be 1.6.
  const std::vector<Vec3d> points = grid(32);
  const std::vector<std::uint32_t> order = insertionOrder(points, 0, Box{{0, 0, 0}, {32, 32, 32}});
  double sum = 0;
  const std::size_t first = order.size() / 7; // well within the last round
  for (std::size_t i = first + 1; i < order.size(); ++i) {
    const Vec3d step = minus(points[order[i]], points[order[i - 1]]);
    sum += std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]);
    EXPECT_LE(length(step), 5);
  }
  EXPECT_LT(sum / static_cast<double>(order.size() - first), 1.2);
}

TEST(InsertionOrder, FirstPointsAreSpreadOverAll) {
  const std::vector<Vec3d> points = grid(32);
  const std::vector<std::uint32_t> order = insertionOrder(points, 0, Box{{0, 0, 0}, {32, 32, 32}});
  std::size_t eighths[8] = {};
  for (std::size_t i = 0; i < 512; ++i) {
    const Vec3d& p = points[order[i]];
    ++eighths[(p[0] > 16 ? 1 : 0) + (p[1] > 16 ? 2 : 0) + (p[2] > 16 ? 4 : 0)];
  }
  EXPECT_GT(*std::min_element(std::begin(eighths), std::end(eighths)), 20u);
}

} // namespace
} // namespace tetvdb
