// SPDX-License-Identifier: Apache-2.0
//
// The header of a .npy file. Internal.
#pragma once

#include "tetvdb/io/volume/arrays/DenseGrid.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// "<f4", and "|b1" for bits.
std::string npyType(ElementType element, bool isBits);

/// Everything before the values, in C order. Format: NEP 1, version 1.0.
std::string npyHeader(std::string_view type, const std::vector<std::uint64_t>& shape);

/// Of a dense grid: [x][y][z], and the components last.
std::string npyHeader(const DenseGrid& grid);

} // namespace tetvdb
