// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/CutLayer.h"

#include "tetvdb/geometry/ClippedFace.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

namespace tetvdb {
namespace {

constexpr int kBeyondRows = 1 << 30; // beyond any row or column

// The part between two heights, in units of the layer's height.
bool cutToLayer(const Polygon& face, Polygon& result) {
  const double low = face.low(2), high = face.high(2);
  if (low >= 1 || high <= 0)
    return false;
  Polygon below, above;
  const Polygon* left = &face;
  if (low < 0) {
    cut(*left, 2, 0, below, above);
    left = &above;
  }
  if (high > 1) {
    Polygon part, rest;
    cut(*left, 2, 1, part, rest);
    result = part;
  } else {
    result = *left;
  }
  return result.count > 2;
}

void addPiece(std::int32_t x, std::int32_t y, std::int32_t baseX, const Polygon& piece, double sign,
              PixelSums& sums) {
  double cover = 0, moment = 0;
  const double* o = piece.at[0];
  const double right = x + 1;
  for (int i = 1; i + 1 < piece.count; ++i) {
    const double *p = piece.at[i], *q = piece.at[i + 1];
    const double twice = (p[1] - o[1]) * (q[2] - o[2]) - (p[2] - o[2]) * (q[1] - o[1]);
    cover += twice;
    moment += twice * ((right - o[0]) + (right - p[0]) + (right - q[0]));
  }
  sums.add(baseX + x, y, cover / 2 * sign, moment / 6 * sign);
}

} // namespace

void addVolumeOfFace(const std::array<const Vec3d*, 3>& corners, int weight,
                     const LayerHeights& layer, PixelSums& sums) {
  std::array<const Vec3d*, 3> p = corners;
  double sign = -weight; // outside is to the right
  // In order of position, so that the numbers do not depend on the order of corners.
  for (const auto& [i, k] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 1)}) {
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(k);
    if (*p[b] < *p[a]) {
      std::swap(p[a], p[b]);
      sign = -sign;
    }
  }
  const Vec3d &a = *p[0], &b = *p[1], &c = *p[2];
  if ((b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]) == 0)
    return; // parallel to the rows
  const double baseX = std::floor(a[0]), baseY = std::floor(std::min({a[1], b[1], c[1]}));
  Polygon face, part;
  for (const Vec3d* q : p) {
    const double corner[3] = {(*q)[0] - baseX, (*q)[1] - baseY,
                              ((*q)[2] - layer.bottom) / layer.height};
    face.add(corner);
  }
  if (!cutToLayer(face, part))
    return;
  const auto x0 = static_cast<std::int32_t>(baseX), y0 = static_cast<std::int32_t>(baseY);
  cutAlong(part, 1, 0, kBeyondRows, [&](int y, const Polygon& row) {
    cutAlong(row, 0, 0, kBeyondRows,
             [&](int x, const Polygon& piece) { addPiece(x, y0 + y, x0, piece, sign, sums); });
  });
}

std::array<double, 2> crossingOfEdge(const Vec3d& a, const Vec3d& b, double z) {
  const bool upward = std::tie(a[2], a[0], a[1]) < std::tie(b[2], b[0], b[1]);
  const Vec3d &low = upward ? a : b, &high = upward ? b : a;
  const double t = std::min((z - low[2]) / (high[2] - low[2]), 1.0);
  const auto between = [&](std::size_t k) {
    const double value = low[k] + t * (high[k] - low[k]);
    return std::clamp(value, std::min(low[k], high[k]), std::max(low[k], high[k]));
  };
  return {between(0), between(1)};
}

namespace {

// A line within a row, from (x0, y0) to (x1, y1), y relative to the row. The area that it covers is
// solid on the right.
void addLineInRow(std::int32_t row, double x0, double y0, double x1, double y1, double sign,
                  PixelSums& sums) {
  if (x1 < x0) {
    std::swap(x0, x1);
    std::swap(y0, y1);
    sign = -sign;
  }
  const double first = std::floor(x0);
  double x = x0, y = y0;
  const auto add = [&](double column, double nextX, double nextY) {
    const double cover = (nextY - y) * sign;
    sums.add(static_cast<std::int32_t>(column), row, cover, cover * (column + 1 - (x + nextX) / 2));
    x = nextX;
    y = nextY;
  };
  double column = first;
  for (; column + 1 < x1; ++column)
    add(column, column + 1, y0 + (y1 - y0) * ((column + 1 - x0) / (x1 - x0)));
  add(column, x1, y1);
}

} // namespace

void addAreaOfLine(const std::array<double, 2>& from, const std::array<double, 2>& to, int weight,
                   PixelSums& sums) {
  const bool upward = from[1] < to[1];
  const auto& low = upward ? from : to;
  const auto& high = upward ? to : from;
  if (low[1] == high[1])
    return;
  // The solid is on the right of a downward line that had it on its left.
  const double sign = upward ? -weight : weight;
  const double slope = (high[0] - low[0]) / (high[1] - low[1]);
  const double leftMost = std::min(low[0], high[0]), rightMost = std::max(low[0], high[0]);
  double x = low[0], y = low[1];
  for (double row = std::floor(low[1]); row < high[1]; ++row) {
    const bool last = row + 1 >= high[1];
    const double nextY = last ? high[1] : row + 1;
    const double nextX =
        last ? high[0] : std::clamp(low[0] + (nextY - low[1]) * slope, leftMost, rightMost);
    addLineInRow(static_cast<std::int32_t>(row), x, y - row, nextX, nextY - row, sign, sums);
    x = nextX;
    y = nextY;
  }
}

} // namespace tetvdb
