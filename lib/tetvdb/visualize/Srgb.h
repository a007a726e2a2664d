// SPDX-License-Identifier: Apache-2.0
//
// The transfer function of sRGB, IEC 61966-2-1, exact in both directions.
#pragma once

#include "tetvdb/visualize/Drawable.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tetvdb {

/// Linear light of an sRGB value, both in [0, 1].
inline float linearOfSrgb(float value) {
  return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
}

/// sRGB value of linear light, both in [0, 1].
inline float srgbOfLinear(float light) {
  return light <= 0.0031308F ? 12.92F * light : 1.055F * std::pow(light, 1 / 2.4F) - 0.055F;
}

/// The nearest of 256 sRGB values; light outside of [0, 1] is clamped, what is no number is black.
inline std::uint8_t srgbByte(float light) {
  const float clamped = light > 0 ? std::min(light, 1.0F) : 0.0F;
  return static_cast<std::uint8_t>(std::lround(srgbOfLinear(clamped) * 255));
}

/// 0xRRGGBB of sRGB as linear light.
inline Rgb rgbOfHex(std::uint32_t hex) {
  Rgb rgb;
  for (std::size_t c = 0; c < 3; ++c)
    rgb[c] = linearOfSrgb(static_cast<float>(hex >> (16 - 8 * c) & 0xFF) / 255);
  return rgb;
}

} // namespace tetvdb
