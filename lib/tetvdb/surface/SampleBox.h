// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/BoxTree.h"

#include <cmath>
#include <cstddef>

namespace tetvdb {

/// Point i of a sequence with uniform density in a box, for any number of points: fractional parts
/// of multiples of the powers of 1 / g, g^4 = g + 1 (M. Roberts, The Unreasonable Effectiveness of
/// Quasirandom Sequences, 2018).
inline Vec3d pointInBox(const Box& box, std::size_t i) {
  constexpr double kStep[3] = {0.8191725133961644, 0.6710436067037892, 0.5497004779019702};
  Vec3d p;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = 0.5 + kStep[axis] * double(i + 1);
    p[axis] = box.low[axis] + (box.high[axis] - box.low[axis]) * (along - std::floor(along));
  }
  return p;
}

} // namespace tetvdb
