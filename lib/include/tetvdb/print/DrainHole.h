// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"

namespace tetvdb {

/// A round hole through a wall; world units.
struct DrainHole {
  Vec3d point{0, 0, 0};     ///< on the axis, in or near the wall
  Vec3d direction{0, 0, 1}; ///< of the axis, of any length except 0
  double radius = 0;
};

} // namespace tetvdb
