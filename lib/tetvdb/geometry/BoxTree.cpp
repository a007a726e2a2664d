// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/BoxTree.h"

#include "tetvdb/geometry/SplitAlongAxis.h"
#include "tetvdb/geometry/VectorMath.h"

#include <numeric>
#include <tbb/parallel_invoke.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kLeafBoxes = 4;
constexpr std::uint32_t kBoxesPerTask = 4096;

} // namespace

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  if (boxes_.empty())
    return;
  std::iota(order_.begin(), order_.end(), 0u);
  std::size_t leaves = 1;
  while (leaves * kLeafBoxes < boxes_.size())
    leaves *= 2;
  nodes_.resize(2 * leaves - 1);
  build(0, 0, static_cast<std::uint32_t>(boxes_.size()));
}

void BoxTree::move(std::uint32_t item, const Box& box) {
  if (leafOf_.empty()) {
    leafOf_.resize(boxes_.size());
    for (std::size_t node = nodes_.size() / 2; node < nodes_.size(); ++node)
      for (std::uint32_t i = nodes_[node].first; i < nodes_[node].last; ++i)
        leafOf_[order_[i]] = static_cast<std::uint32_t>(node);
  }
  boxes_[item] = box;
  if (box.low[0] > box.high[0])
    return;
  for (std::size_t node = leafOf_[item]; !nodes_[node].box.contains(box); node = (node - 1) / 2) {
    nodes_[node].box.add(box);
    if (node == 0)
      return;
  }
}

void BoxTree::build(std::size_t node, std::uint32_t first, std::uint32_t last) {
  Node& here = nodes_[node];
  here.first = first;
  here.last = last;
  for (std::uint32_t i = first; i < last; ++i)
    here.box.add(boxes_[order_[i]]);
  if (2 * node + 2 >= nodes_.size())
    return;
  const std::uint32_t midpoint = first + (last - first) / 2;
  splitAlongAxis(
      longestAxis(here.box.low, here.box.high), order_.begin() + first, order_.begin() + midpoint,
      order_.begin() + last,
      [&](std::uint32_t item) { return plus(boxes_[item].low, boxes_[item].high); },
      [](std::uint32_t item) { return item; });
  const auto left = [&] { build(2 * node + 1, first, midpoint); };
  const auto right = [&] { build(2 * node + 2, midpoint, last); };
  if (last - first > kBoxesPerTask) {
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
}

} // namespace tetvdb
