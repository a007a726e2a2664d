// SPDX-License-Identifier: Apache-2.0
//
// Items in two halves along the longest side of their box: a step in the making of every tree and
// partition of space here.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <type_traits>

namespace tetvdb {

/// The axis of a box's longest side, the first of equally long ones.
template <class Corner>
std::size_t longestAxis(const Corner& low, const Corner& high) {
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis)
    if (high[axis] - low[axis] > high[longest] - low[longest])
      longest = axis;
  return longest;
}

/// That of the box of position(item), three coordinates, of the items from `first` to `last`.
template <class Iterator, class Position>
std::size_t longestAxis(Iterator first, Iterator last, const Position& position) {
  using Real = std::decay_t<decltype(position(*first)[0])>;
  constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
  Real low[3] = {kInfinity, kInfinity, kInfinity}, high[3] = {-kInfinity, -kInfinity, -kInfinity};
  for (; first != last; ++first) {
    const auto& p = position(*first);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  return longestAxis(low, high);
}

/// Moves the items that come first along an axis to before `nth`. tie(item) orders those at equal
/// places; items that differ in it are parted in one way, whatever their order is. O(n).
template <class Iterator, class Position, class Tie>
void splitAlongAxis(std::size_t axis, Iterator first, Iterator nth, Iterator last,
                    const Position& position, const Tie& tie) {
  std::nth_element(first, nth, last, [&](const auto& a, const auto& b) {
    const auto x = position(a)[axis], y = position(b)[axis];
    return x != y ? x < y : tie(a) < tie(b);
  });
}

} // namespace tetvdb
