// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/HostDevice.h"
#include "tetvdb/core/Multiversion.h"

#include <cmath>

namespace tetvdb {

/// std::atan2(sine, cosine) within 1e-11, without branches, for vectorised loops. NaN if both are
/// zero. The arc tangent of the smaller over the larger is computed, above tan(pi / 8) by atan(t)
/// = pi / 4 + atan((t - 1) / (t + 1)), by the power series, whose first omitted term is below
/// 1e-11.
TETVDB_HD TETVDB_INLINE double arcTangent(double sine, double cosine) {
  const double y = std::abs(sine), x = std::abs(cosine);
  const double low = y < x ? y : x, high = y < x ? x : y;
  const bool steep = low > 0.41421356237309503 * high;
  const double u = (steep ? low - high : low) / (steep ? low + high : high);
  const double v = u * u;
  // Two chains of alternating terms are evaluated in parallel.
  const double w = v * v;
  double even = 1.0 / 25, odd = 1.0 / 23;
  even = even * w + 1.0 / 21;
  odd = odd * w + 1.0 / 19;
  even = even * w + 1.0 / 17;
  odd = odd * w + 1.0 / 15;
  even = even * w + 1.0 / 13;
  odd = odd * w + 1.0 / 11;
  even = even * w + 1.0 / 9;
  odd = odd * w + 1.0 / 7;
  even = even * w + 1.0 / 5;
  odd = odd * w + 1.0 / 3;
  even = even * w + 1.0;
  const double series = even - v * odd;
  double angle = (steep ? kPi / 4 : 0.0) + u * series;
  angle = y < x ? angle : kPi / 2 - angle;
  angle = cosine < 0 ? kPi - angle : angle;
  return sine < 0 ? -angle : angle;
}

} // namespace tetvdb
