// SPDX-License-Identifier: Apache-2.0
//
// The distance from which a pixel's rays can hit anything, found by projecting boxes that cover a
// drawable: rays skip the empty space in front of it, and pixels without it need no ray.
//
//   tetvdb::EntryMap map(camera);
//   if (drawable.mark(map))
//     ray.tMin = map.at(x, y);   // infinity: nothing is hit
#pragma once

#include "tetvdb/visualize/Camera.h"

#include <atomic>
#include <cstddef>
#include <vector>

namespace tetvdb {

/// 4 bytes a pixel. The result does not depend on the order of boxes.
class EntryMap {
public:
  explicit EntryMap(const Camera& camera);

  const View& view() const { return camera_.view(); }
  /// A box with its centre in the world, and how far it reaches from there (world units) along the
  /// view's axes: right, up, towards the eye. Thread-safe. Costs as many steps as it covers pixels.
  void add(const Vec3d& centre, const Vec3d& reach);

  /// A lower bound on t of all boxes along all rays through the pixel; infinity where there is no
  /// box.
  float at(int x, int y) const { return entries_[index(x, y)].load(std::memory_order_relaxed); }

private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width()) +
           static_cast<std::size_t>(x);
  }

  const Camera& camera_;
  std::vector<std::atomic<float>> entries_;
};

} // namespace tetvdb
