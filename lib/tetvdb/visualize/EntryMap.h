// SPDX-License-Identifier: Apache-2.0
//
// From where on a pixel's rays can meet anything, found by projecting boxes that hold all there is:
// no ray need look for what is empty, nor be shot where nothing is.
//
//   tetvdb::EntryMap map(camera);
//   if (drawable.mark(map))
//     ray.tMin = map.at(x, y);   // infinity: nothing is there
#pragma once

#include "tetvdb/visualize/Camera.h"

#include <atomic>
#include <cstddef>
#include <vector>

namespace tetvdb {

/// 4 bytes a pixel. The result does not depend on the order in which boxes come.
class EntryMap {
public:
  explicit EntryMap(const Camera& camera);

  const View& view() const { return camera_.view(); }
  /// A box with its middle in the world, and how far it reaches from there (world units) along the
  /// view's axes: right, up, towards the eye. Thread-safe. Costs as many steps as it covers pixels.
  void add(const Vec3d& middle, const Vec3d& reach);

  /// A t that no box's points lie before on rays through any part of the pixel; infinity where no
  /// box is.
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
