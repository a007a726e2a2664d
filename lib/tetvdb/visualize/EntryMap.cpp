// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/EntryMap.h"

#include "tetvdb/core/AtomicBounds.h"

#include <limits>

namespace tetvdb {
namespace {

// Entries are floats; this much less is less after rounding, too.
constexpr double kNearer = 1 - 1e-6;

} // namespace

EntryMap::EntryMap(const Camera& camera)
    : camera_(camera), entries_(static_cast<std::size_t>(camera.width()) *
                                static_cast<std::size_t>(camera.height())) {
  for (std::atomic<float>& entry : entries_)
    entry.store(std::numeric_limits<float>::infinity(), std::memory_order_relaxed);
}

void EntryMap::add(const Vec3d& centre, const Vec3d& reach) {
  const Camera::Footprint print = camera_.footprint(centre, reach);
  const auto nearest = static_cast<float>(print.depth * kNearer);
  for (int y = print.top; y <= print.bottom; ++y)
    for (int x = print.left; x <= print.right; ++x)
      lowerTo(entries_[index(x, y)], nearest);
}

} // namespace tetvdb
