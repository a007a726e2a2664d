// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/visualize/Camera.h"
#include "tetvdb/visualize/Drawable.h"
#include "tetvdb/visualize/Image.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace tetvdb {

/// Everything that is in a picture.
struct Scene {
  std::vector<std::shared_ptr<const Drawable>> drawables;
  std::vector<std::shared_ptr<const Medium>> media;
  /// From the upper edge of the picture to the lower one; may be transparent.
  Pixel backgroundTop, backgroundBottom;

  Box bounds() const {
    Box box;
    for (const auto& drawable : drawables)
      box.add(drawable->bounds());
    for (const auto& medium : media)
      box.add(medium->bounds());
    return box;
  }
  /// For frame(); the scene must outlive it.
  Support support() const {
    return [this](const Vec3d& direction) {
      double reach = -std::numeric_limits<double>::infinity();
      for (const auto& drawable : drawables)
        reach = std::max(reach, drawable->support(direction));
      for (const auto& medium : media)
        reach = std::max(reach, medium->support(direction));
      return reach;
    };
  }
};

} // namespace tetvdb
