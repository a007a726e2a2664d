// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tetvdb {

/// The rule that combines several inputs.
enum class Boolean : std::uint8_t {
  Materials,   ///< what is in any input; where several overlap, the earliest owns it
  Union,       ///< what is in any input, as one solid
  Difference,  ///< what is in the first and in no other
  Intersection ///< what is in all
};

} // namespace tetvdb
