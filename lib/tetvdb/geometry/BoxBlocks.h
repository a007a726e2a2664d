// SPDX-License-Identifier: Apache-2.0
//
// Boxes in blocks of eight along a space-filling curve, and these in blocks of eight again: fast to
// build, and fast to query for pairs of intersecting boxes.
#pragma once

#include "tetvdb/core/LargeVector.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/BoxTree.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace tetvdb {

/// Boxes are stored in single precision, rounded outward: all intersecting pairs are found, and
/// some separated by less than 2^-22 of their distance from 0. Coordinates must be finite.
/// Independent of the number of threads; queries are thread-safe.
class BoxBlocks {
public:
  static constexpr std::size_t kWidth = 8;

  /// Of boxOf(0) to boxOf(count - 1), which several threads call. About 40 ns of a core per box.
  BoxBlocks(std::size_t count, const std::function<Box(std::size_t)>& boxOf);

  std::size_t blocks() const { return levels_.empty() ? 0 : levels_.front().size(); }

  /// Adds to `found` the pairs whose first box is in block `block` and the second in it or a later
  /// one; ends when it contains more than `max`. All blocks together give every intersecting pair
  /// once.
  void pairs(std::size_t block, std::size_t max,
             std::vector<std::pair<std::uint32_t, std::uint32_t>>& found) const;

  /// Calls found(item) for the boxes that a line along `axis` intersects at position `at` or above
  /// it; ends when found() returns true.
  template <typename Found>
  void above(std::size_t axis, const Vec3d& at, const Found& found) const;

private:
  // Eight boxes, by coordinate. Missing boxes are empty.
  struct alignas(64) Block {
    std::array<std::array<float, kWidth>, 3> low, high;
  };
  struct FloatBox {
    std::array<float, 3> low, high;
  };
  // A bit for each box of the block that intersects the other.
  TETVDB_INLINE static unsigned meeting(const Block& block, const FloatBox& box) {
    typedef float Floats __attribute__((vector_size(kWidth * sizeof(float))));
    typedef std::int32_t Ints __attribute__((vector_size(kWidth * sizeof(std::int32_t))));
    const Floats* low = reinterpret_cast<const Floats*>(block.low.data());
    const Floats* high = reinterpret_cast<const Floats*>(block.high.data());
    const Ints meets = (low[0] <= box.high[0]) & (high[0] >= box.low[0]) & (low[1] <= box.high[1]) &
                       (high[1] >= box.low[1]) & (low[2] <= box.high[2]) & (high[2] >= box.low[2]);
    const Ints bits = meets & Ints{1, 2, 4, 8, 16, 32, 64, 128};
    typedef std::uint64_t Halves __attribute__((vector_size(kWidth * sizeof(std::int32_t))));
    const auto two = reinterpret_cast<Halves>(bits); // the same bytes
    const std::uint64_t one = two[0] | two[1] | two[2] | two[3];
    return static_cast<unsigned>(one | one >> 32);
  }
  static FloatBox outward(const Box& box);
  static FloatBox boxIn(const Block& block, std::size_t i) {
    return {{block.low[0][i], block.low[1][i], block.low[2][i]},
            {block.high[0][i], block.high[1][i], block.high[2][i]}};
  }
  static FloatBox boundOf(const Block& block);

  // Calls visit(block of the lowest level) for those with boxes that intersect `box` and a number
  // of at least `first`, ascending; ends when visit() returns true.
  template <typename Visit>
  TETVDB_INLINE void descend(const FloatBox& box, std::size_t first, const Visit& visit) const {
    struct Place {
      std::size_t level, block;
    };
    std::array<Place, kWidth * 24> stack;
    std::size_t depth = 0;
    if (!levels_.empty())
      stack[depth++] = {levels_.size() - 1, 0};
    while (depth > 0) {
      const auto [level, block] = stack[--depth];
      if (level == 0) {
        if (visit(block))
          return;
        continue;
      }
      const unsigned bits = meeting(levels_[level][block], box);
      for (std::size_t i = kWidth; i-- > 0;) {
        const std::size_t child = kWidth * block + i;
        // The last block of the lowest level below the child.
        if ((bits >> i & 1) != 0 && (child + 1) << (3 * (level - 1)) > first)
          stack[depth++] = {level - 1, child};
      }
    }
  }

  LargeVector<std::uint32_t> order_;       // item in each place of the lowest level
  std::vector<LargeVector<Block>> levels_; // the lowest first; block i of one holds 8 i ... 8 i + 7
  LargeVector<FloatBox> bounds_;           // of the lowest level's blocks
};

template <typename Found>
void BoxBlocks::above(std::size_t axis, const Vec3d& at, const Found& found) const {
  Box line;
  line.add(at);
  FloatBox box = outward(line);
  box.high[axis] = std::numeric_limits<float>::max();
  descend(box, 0, [&](std::size_t block) {
    for (unsigned bits = meeting(levels_.front()[block], box); bits != 0; bits &= bits - 1)
      if (found(order_[kWidth * block + static_cast<std::size_t>(__builtin_ctz(bits))]))
        return true;
    return false;
  });
}

} // namespace tetvdb
