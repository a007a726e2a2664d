// SPDX-License-Identifier: Apache-2.0
//
// Numbers as text, with only the significant digits.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstdint>
#include <string>

namespace tetvdb::cli {

/// "640 bytes", "12.3 kB", "1.25 MB": three digits, powers of 1000.
std::string bytesText(std::uint64_t bytes);

/// A length by itself, with seven digits at most.
std::string lengthText(double length);
/// One length where all three are the same, else "1 x 2 x 3".
std::string lengthText(const Vec3d& lengths);

/// "(1.5, 0, -2)": a point of something as large as `extent`, to a ten-millionth of it, so that
/// rounding errors become 0 and points far from the origin keep their digits. At most 15 digits,
/// the precision of a double; seven if the extent is not above zero.
std::string pointText(const Vec3d& point, double extent);
/// The largest side of a box.
double extentOf(const Vec3d& low, const Vec3d& high);

} // namespace tetvdb::cli
