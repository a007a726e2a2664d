// SPDX-License-Identifier: Apache-2.0
//
// Rows of a layer with one bit per pixel.
#pragma once

#include "tetvdb/print/Layer.h"

#include <cstddef>

namespace tetvdb {

/// Minimum grey level of white in images with one bit per pixel.
constexpr int kWhiteFrom = 128;

/// Sets the bits of the white pixels of layer.rows[row], the first pixel in the highest bit. Bytes
/// within a run are set as a whole.
inline void setRowBits(const Layer& layer, std::size_t row, char* bytes) {
  const auto [begin, end] = layer.runsOf(row);
  for (const PixelRun* run = begin; run != end; ++run) {
    if (run->value < kWhiteFrom)
      continue;
    for (std::int32_t x = run->begin; x < run->end;) {
      char& byte = bytes[x >> 3];
      if ((x & 7) == 0 && x + 8 <= run->end) {
        byte = static_cast<char>(0xff);
        x += 8;
      } else {
        byte = static_cast<char>(byte | 0x80 >> (x & 7));
        ++x;
      }
    }
  }
}

} // namespace tetvdb
