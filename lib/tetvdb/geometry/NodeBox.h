// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/geometry/NodeIndex.h"

#include <cstddef>

namespace tetvdb {

/// The 128^3 nodes low <= node < high.
struct NodeBox {
  NodeIndex low{0, 0, 0}, high{0, 0, 0};
};

/// Calls visit(begin, end) for the ranges of `nodes`, which ascend, that are in `box`: one for each
/// x and y. nodeAt(i): node i of `count`.
template <typename NodeAt, typename Visit>
void eachRangeIn(const NodeBox& box, std::size_t count, const NodeAt& nodeAt, const Visit& visit) {
  const auto lowerBound = [&](const NodeIndex& wanted, std::size_t from) {
    std::size_t low = from, high = count;
    while (low < high) {
      const std::size_t middle = low + (high - low) / 2;
      if (nodeAt(middle) < wanted)
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  };
  std::size_t at = 0;
  for (std::int32_t x = box.low[0]; x < box.high[0]; ++x)
    for (std::int32_t y = box.low[1]; y < box.high[1]; ++y) {
      at = lowerBound({x, y, box.low[2]}, at);
      if (at == count)
        return;
      const std::size_t end = lowerBound({x, y, box.high[2]}, at);
      if (end != at)
        visit(at, end);
      at = end;
    }
}

} // namespace tetvdb
