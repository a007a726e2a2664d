// SPDX-License-Identifier: Apache-2.0
//
// Eight bits of a leaf's mask as eight lanes of all ones or zeros, so that loops over a leaf's
// active values can be vectorised. Internal.
#pragma once

#include <array>
#include <cstdint>

namespace tetvdb {

using LaneMasks = std::array<std::array<std::uint32_t, 8>, 256>;

constexpr LaneMasks makeLaneMasks() {
  LaneMasks masks{};
  for (unsigned byte = 0; byte < 256; ++byte)
    for (unsigned bit = 0; bit < 8; ++bit)
      masks[byte][bit] = (byte >> bit & 1) != 0 ? ~0U : 0U;
  return masks;
}

inline constexpr LaneMasks kLaneMasks = makeLaneMasks();

} // namespace tetvdb
