// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/visualize/Drawable.h"

namespace tetvdb {

/// A subject that is cut: the side dot(normal, p) <= offset is kept.
struct CutPlane {
  Vec3d normal{1, 0, 0}; ///< of length 1
  double offset = 0;     ///< world units
  /// Shortens the ray to its part that is kept; false where none is. `entered`: it now begins on
  /// the plane.
  bool clip(Ray& ray, bool& entered) const;
};

} // namespace tetvdb
