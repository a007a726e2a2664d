// SPDX-License-Identifier: Apache-2.0
//
// Numbers that several folders need.
#pragma once

#include <cstddef>

namespace tetvdb {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadiansPerDegree = kPi / 180;

/// Lines, points or faces that a loop over a file handles between two looks at its progress.
constexpr std::size_t kItemsPerUpdate = std::size_t(1) << 16;

} // namespace tetvdb
