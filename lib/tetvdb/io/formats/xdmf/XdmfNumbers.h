// SPDX-License-Identifier: Apache-2.0
//
// What XDMF's numbers mean. Internal.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace tetvdb {

/// A number of an array of integers or floats as an index; kNoXdmfIndex if it is invalid.
constexpr std::uint64_t kNoXdmfIndex = std::numeric_limits<std::uint64_t>::max();
template <typename T>
std::uint64_t xdmfIndex(T value) {
  if constexpr (std::is_floating_point_v<T>)
    return value >= 0 && value <= T(4294967294.0) && value == std::floor(value)
               ? static_cast<std::uint64_t>(value)
               : kNoXdmfIndex;
  else
    return value >= 0 ? static_cast<std::uint64_t>(value) : kNoXdmfIndex;
}

/// The point of an index counted from `offset`; 2^32 - 1, which no mesh has, if it is invalid.
inline std::uint32_t xdmfNode(std::uint64_t index, std::uint64_t offset) {
  const bool fits = index != kNoXdmfIndex && index >= offset && index - offset < 0xffffffffu;
  return fits ? static_cast<std::uint32_t>(index - offset) : 0xffffffffu;
}

/// From xx, xy, xz, yy, yz, zz to VTK's order, xx, yy, zz, xy, yz, xz.
template <class Numbers>
void orderXdmfTensor(Numbers& numbers) {
  constexpr std::array<std::size_t, 6> from{0, 3, 5, 1, 4, 2};
  for (std::size_t at = 0; at + 6 <= numbers.size(); at += 6) {
    typename Numbers::value_type one[6];
    std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(at), 6, one);
    for (std::size_t k = 0; k < 6; ++k)
      numbers[at + k] = one[from[k]];
  }
}

} // namespace tetvdb
