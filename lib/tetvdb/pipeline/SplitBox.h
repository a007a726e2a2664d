// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/geometry/NodeBox.h"

#include <array>
#include <cstddef>
#include <vector>

namespace tetvdb {

/// A box of nodes, which may be cut further along `axis` and those after it.
struct SplitBox {
  NodeBox box;
  std::size_t axis = 0;
};

constexpr std::int32_t kNodesInCube = kRootChildSize / kNodeSize;

/// Appends boxes that together are `box`, each node of one before each of the next, by x, then y,
/// then z: as few along its axis as `limit` allows, and a layer that is too large along the next.
/// nodeAt(i), weightAt(i): of `count` nodes, which ascend. No side has more than kNodesInCube
/// nodes.
template <typename NodeAt, typename WeightAt>
void splitBox(const SplitBox& whole, std::size_t count, const NodeAt& nodeAt,
              const WeightAt& weightAt, double limit, std::vector<SplitBox>& parts) {
  std::array<double, kNodesInCube> layers{};
  const NodeBox& bounds = whole.box;
  const std::size_t along = whole.axis;
  eachRangeIn(bounds, count, nodeAt, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      layers[static_cast<std::size_t>(nodeAt(i)[along] - bounds.low[along])] += weightAt(i);
  });
  SplitBox part = whole;
  double sum = 0;
  const auto flush = [&](std::int32_t end) {
    part.box.high[along] = end;
    if (part.box.low[along] < end)
      parts.push_back(part);
    part.box.low[along] = end;
    sum = 0;
  };
  for (std::int32_t i = bounds.low[along]; i < bounds.high[along]; ++i) {
    const double layer = layers[static_cast<std::size_t>(i - bounds.low[along])];
    if (sum + layer > limit)
      flush(i);
    sum += layer;
    if (layer > limit && along < 2) {
      part.box.high[along] = i + 1;
      splitBox({part.box, along + 1}, count, nodeAt, weightAt, limit, parts);
      part.box.low[along] = i + 1;
      sum = 0;
    }
  }
  flush(bounds.high[along]);
}

} // namespace tetvdb
