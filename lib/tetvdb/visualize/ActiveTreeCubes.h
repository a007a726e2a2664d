// SPDX-License-Identifier: Apache-2.0
//
// All nodes and tiles of an ActiveTree. Internal.
#pragma once

#include "tetvdb/visualize/ActiveTree.h"

#include <tbb/parallel_for.h>

namespace tetvdb {

template <class F>
void ActiveTree::forLeaves(std::size_t lower, const F& f) const {
  const Lower& node = lowers_[lower];
  const Vec3i& origin = lowerOrigins_[lower];
  for (std::uint32_t block = 0; block < 64; ++block)
    for (std::uint64_t rest = node.cells[block]; rest != 0; rest &= rest - 1) {
      const std::uint32_t cell = openvdb::util::FindLowestOn(rest);
      const auto along = [&](int shift) { return (block >> shift & 3) << 2 | (cell >> shift & 3); };
      const std::uint32_t bit = along(4) << 8 | along(2) << 4 | along(0);
      f(Vec3i{origin[0] + 8 * std::int32_t(along(4)), origin[1] + 8 * std::int32_t(along(2)),
              origin[2] + 8 * std::int32_t(along(0))},
        node.children->isOn(bit) ? leaves_[node.child(bit)].mask : nullptr);
    }
}

template <class F>
void ActiveTree::forLargeTiles(const F& f) const {
  for (const auto& [key, at] : root_) {
    const auto part = [k = key](int shift) { // 20 bits, with their sign
      return std::int32_t(std::uint32_t(k >> shift) << 12);
    };
    const Vec3i origin{part(40), part(20), part(0)};
    if (!at.upper) {
      if (at.on)
        f(origin, 4096);
      continue;
    }
    for (std::uint32_t bit = 0; bit < Mask5::SIZE; ++bit)
      if (at.upper->tiles->isOn(bit))
        f(Vec3i{origin[0] + 128 * std::int32_t(bit >> 10),
                origin[1] + 128 * std::int32_t(bit >> 5 & 31),
                origin[2] + 128 * std::int32_t(bit & 31)},
          128);
  }
}

template <class F>
void ActiveTree::forCubes(const F& f) const {
  forLargeTiles(f);
  tbb::parallel_for(std::size_t(0), lowers_.size(), [&](std::size_t i) {
    forLeaves(i, [&](const Vec3i& low, const Mask3*) { f(low, 8); });
  });
}

} // namespace tetvdb
