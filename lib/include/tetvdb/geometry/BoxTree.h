// SPDX-License-Identifier: Apache-2.0
//
// A tree of axis-aligned boxes: finds the boxes that intersect, or contain, a given one.
//
//   tetvdb::BoxTree tree(boxes);
//   tree.visit([&](const Box& b) { return b.meets(mine); },
//              [&](std::uint32_t item) { found.push_back(item); return false; });
#pragma once

#include "tetvdb/core/Vec3.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tetvdb {

/// Closed; initially empty.
struct Box {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3d low{kInfinity, kInfinity, kInfinity};
  Vec3d high{-kInfinity, -kInfinity, -kInfinity};

  void add(const Vec3d& p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  void add(const Box& other) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], other.low[axis]);
      high[axis] = std::max(high[axis], other.high[axis]);
    }
  }
  bool meets(const Box& other) const {
    return low[0] <= other.high[0] && other.low[0] <= high[0] && low[1] <= other.high[1] &&
           other.low[1] <= high[1] && low[2] <= other.high[2] && other.low[2] <= high[2];
  }
  bool contains(const Box& other) const {
    return low[0] <= other.low[0] && other.high[0] <= high[0] && low[1] <= other.low[1] &&
           other.high[1] <= high[1] && low[2] <= other.low[2] && other.high[2] <= high[2];
  }
  bool contains(const Vec3d& p) const { return contains(Box{p, p}); }
};

/// Split at the median of the longest side, so that the depth is the logarithm of the number of
/// boxes in all cases. Independent of the number of threads; queries are thread-safe.
class BoxTree {
public:
  explicit BoxTree(std::vector<Box> boxes);

  std::size_t size() const { return boxes_.size(); }
  const Box& box(std::uint32_t item) const { return boxes_[item]; }

  /// Replaces the box of an item; an empty box removes the item. visit() remains correct, but
  /// slows down as boxes move away from their positions when the tree was built. Not
  /// thread-safe.
  void move(std::uint32_t item, const Box& box);

  /// Calls found(item) for items whose box, and whose ancestors' boxes, satisfy enter(box); ends
  /// when found() returns true. enter(b) must hold for every box that contains a b' with enter(b').
  template <typename Enter, typename Found>
  void visit(const Enter& enter, const Found& found) const {
    if (boxes_.empty())
      return;
    std::size_t stack[64], depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::size_t node = stack[--depth];
      if (!enter(nodes_[node].box))
        continue;
      if (2 * node + 2 < nodes_.size()) {
        stack[depth++] = 2 * node + 2;
        stack[depth++] = 2 * node + 1;
        continue;
      }
      for (std::uint32_t i = nodes_[node].first; i < nodes_[node].last; ++i)
        if (enter(boxes_[order_[i]]) && found(order_[i]))
          return;
    }
  }

private:
  // Children of node i: 2 i + 1 and 2 i + 2. All leaves have the same depth.
  struct Node {
    Box box;
    std::uint32_t first = 0, last = 0; ///< in order_
  };
  void build(std::size_t node, std::uint32_t first, std::uint32_t last);

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leafOf_; ///< by item: its node; made by the first move()
};

} // namespace tetvdb
