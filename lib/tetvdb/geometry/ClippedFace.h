// SPDX-License-Identifier: Apache-2.0
//
// A face cut along the planes between voxels.
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/core/Multiversion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tetvdb {

/// A convex polygon in space, with at most the number of corners of a triangle after six cuts.
struct Polygon {
  static constexpr int kMax = 10;
  int count = 0;
  double at[kMax][3];

  TETVDB_HD double low(int axis) const {
    double min = at[0][axis];
    for (int i = 1; i < count; ++i)
      min = std::min(min, at[i][axis]);
    return min;
  }
  TETVDB_HD double high(int axis) const {
    double max = at[0][axis];
    for (int i = 1; i < count; ++i)
      max = std::max(max, at[i][axis]);
    return max;
  }
  TETVDB_HD void add(const double* p) {
    at[count][0] = p[0];
    at[count][1] = p[1];
    at[count][2] = p[2];
    ++count;
  }
};

/// Cuts `polygon` at coordinate `c` of `axis` into the parts below and above. Corners on the cut
/// belong to both; new ones have exactly the coordinate `c`.
TETVDB_HD inline void cut(const Polygon& polygon, int axis, double c, Polygon& below,
                          Polygon& above) {
  below.count = above.count = 0;
  for (int i = 0; i < polygon.count; ++i) {
    const double* p = polygon.at[i];
    const double* q = polygon.at[i + 1 == polygon.count ? 0 : i + 1];
    const double sp = p[axis] - c, sq = q[axis] - c;
    if (sp <= 0)
      below.add(p);
    if (sp >= 0)
      above.add(p);
    if ((sp < 0 && sq > 0) || (sp > 0 && sq < 0)) {
      const double t = sp / (sp - sq);
      double r[3];
      for (int k = 0; k < 3; ++k)
        r[k] = p[k] + t * (q[k] - p[k]);
      r[axis] = c;
      below.add(r);
      above.add(r);
    }
  }
}

/// Calls piece(i, part) for the part of `polygon` between i and i + 1 along `axis`, for first <= i
/// <= last only. A polygon within the plane i belongs to i only.
template <typename Piece>
TETVDB_HD TETVDB_INLINE void cutAlong(const Polygon& polygon, int axis, int first, int last,
                                      const Piece& piece) {
  const double low = polygon.low(axis), high = polygon.high(axis);
  if (high < first || (high == first && low < high) || low >= last + 1)
    return;
  const int begin = std::max(first, static_cast<int>(std::floor(low)));
  const int end = std::min(last, static_cast<int>(std::ceil(high)) - 1);
  Polygon rest[2], part;
  const Polygon* left = &polygon;
  int spare = 0;
  if (low < begin) {
    cut(*left, axis, begin, part, rest[spare]);
    left = &rest[spare];
    spare = 1 - spare;
  }
  for (int i = begin; i < end; ++i) {
    cut(*left, axis, i + 1, part, rest[spare]);
    left = &rest[spare];
    spare = 1 - spare;
    if (part.count > 2)
      piece(i, part);
  }
  if (high > end + 1) {
    cut(*left, axis, end + 1, part, rest[spare]);
    left = &part;
  }
  if (left->count > 2)
    piece(std::max(begin, end), *left);
}

} // namespace tetvdb
