// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tetvdb {

/// Which winding numbers are inside.
enum class FillRule : std::uint8_t { Positive, NonZero, Odd };

} // namespace tetvdb
