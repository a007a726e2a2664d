// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/Image.h"

#include "tetvdb/visualize/Srgb.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_for.h>

namespace tetvdb {

void Image::paste(const Image& other, int x, int y) {
  for (int row = std::max(0, -y); row < std::min(other.height, height - y); ++row)
    for (int column = std::max(0, -x); column < std::min(other.width, width - x); ++column)
      at(x + column, y + row) = other.at(column, row);
}

bool Image::isOpaque() const {
  return std::all_of(pixels.begin(), pixels.end(), [](const Pixel& p) { return p.alpha >= 1; });
}

std::vector<std::uint8_t> srgbBytes(const Image& image, bool withAlpha) {
  const std::size_t channels = withAlpha ? 4 : 3;
  std::vector<std::uint8_t> bytes(image.pixels.size() * channels);
  tbb::parallel_for(std::size_t(0), static_cast<std::size_t>(image.height), [&](std::size_t row) {
    const auto width = static_cast<std::size_t>(image.width);
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      const Pixel& p = image.pixels[i];
      const float whole = withAlpha && p.alpha > 0 ? 1 / p.alpha : 1;
      bytes[i * channels] = srgbByte(p.red * whole);
      bytes[i * channels + 1] = srgbByte(p.green * whole);
      bytes[i * channels + 2] = srgbByte(p.blue * whole);
      if (withAlpha)
        bytes[i * channels + 3] =
            static_cast<std::uint8_t>(std::lround(std::clamp(p.alpha, 0.0F, 1.0F) * 255));
    }
  });
  return bytes;
}

} // namespace tetvdb
