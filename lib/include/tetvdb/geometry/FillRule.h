// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/HostDevice.h"

#include <cstdint>

namespace tetvdb {

/// Which winding numbers are inside.
enum class FillRule : std::uint8_t { Positive, NonZero, Odd };

TETVDB_HD inline bool isInside(std::int32_t winding, FillRule rule) {
  return rule == FillRule::Positive  ? winding > 0
         : rule == FillRule::NonZero ? winding != 0
                                     : (winding & 1) != 0;
}

} // namespace tetvdb
