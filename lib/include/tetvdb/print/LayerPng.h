// SPDX-License-Identifier: Apache-2.0
//
// Writes layers as PNG files from their runs: the time depends on the runs, not the pixels.
#pragma once

#include "tetvdb/print/Layer.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

using PngColor = std::array<std::uint8_t, 3>;

/// A PNG file (ISO/IEC 15948) of 8-bit grey levels, not interlaced; with a palette, of indices into
/// it. Rows are not filtered. The bytes depend on the pixels only. Thread-safe. Throws Error(Limit)
/// for a packed image of 2 GiB or more.
std::string encodeLayerPng(const Layer& layer, std::int32_t width, std::int32_t height,
                           const std::vector<PngColor>& palette = {});

} // namespace tetvdb
