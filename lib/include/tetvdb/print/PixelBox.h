// SPDX-License-Identifier: Apache-2.0
//
// Neighbourhoods of pixels in a layer, and boxes of pixels.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace tetvdb {

/// The pixels to which a pixel of a layer is connected: those that share a side, or also those that
/// share a corner.
enum class Neighbours : std::uint8_t { Four, Eight };

/// Pixels minX to maxX of the rows minY to maxY; empty where max < min.
struct PixelBox {
  std::int32_t minX = std::numeric_limits<std::int32_t>::max(), minY = minX;
  std::int32_t maxX = std::numeric_limits<std::int32_t>::min(), maxY = maxX;

  void include(const PixelBox& o) {
    minX = std::min(minX, o.minX);
    minY = std::min(minY, o.minY);
    maxX = std::max(maxX, o.maxX);
    maxY = std::max(maxY, o.maxY);
  }
};

} // namespace tetvdb
