// SPDX-License-Identifier: Apache-2.0
//
// Numbers for people: the digits that matter and no others.
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
/// what is rounding beside the rest is 0, and what is far from the origin keeps its digits. 15
/// digits at most, which is all that a double holds; seven where the extent is not above zero.
std::string pointText(const Vec3d& point, double extent);
/// The largest side of a box.
double extentOf(const Vec3d& low, const Vec3d& high);

} // namespace tetvdb::cli
