// SPDX-License-Identifier: Apache-2.0
//
// A picture in linear light, and as sRGB bytes.
#pragma once

#include "tetvdb/visualize/Drawable.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Light that comes through a pixel, and how much of what lies behind it is hidden. Light is
/// premultiplied: a pixel half covered by white is {0.5, 0.5, 0.5, 0.5}.
struct Pixel {
  float red = 0, green = 0, blue = 0, alpha = 0;

  friend bool operator==(const Pixel& a, const Pixel& b) {
    return a.red == b.red && a.green == b.green && a.blue == b.blue && a.alpha == b.alpha;
  }
};

/// An opaque pixel of a colour.
inline Pixel opaque(const Rgb& color) {
  return {color[0], color[1], color[2], 1};
}

/// `front` before `back`.
inline Pixel over(const Pixel& front, const Pixel& back) {
  const float rest = 1 - front.alpha;
  return {front.red + rest * back.red, front.green + rest * back.green,
          front.blue + rest * back.blue, front.alpha + rest * back.alpha};
}

/// A pixel's light and cover, both so many times as much.
inline Pixel scaled(const Pixel& p, float share) {
  return {p.red * share, p.green * share, p.blue * share, p.alpha * share};
}

/// Row 0 is the top one.
struct Image {
  int width = 0, height = 0;
  std::vector<Pixel> pixels; ///< row by row

  Image() = default;
  Image(int w, int h, const Pixel& fill = {})
      : width(w), height(h),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill) {}

  Pixel& at(int x, int y) { return pixels[index(x, y)]; }
  const Pixel& at(int x, int y) const { return pixels[index(x, y)]; }
  bool has(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  /// Puts a pixel before the one at (x, y); no effect outside of the picture.
  void draw(int x, int y, const Pixel& front) {
    if (has(x, y))
      at(x, y) = over(front, at(x, y));
  }
  /// Copies `other` with its upper left corner to (x, y); what is outside is left out.
  void paste(const Image& other, int x, int y);
  bool isOpaque() const;

private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// Bytes of sRGB: red, green, blue, and alpha (linear, colours not premultiplied) where
/// `withAlpha`. Rows follow each other from the top without gaps.
std::vector<std::uint8_t> srgbBytes(const Image& image, bool withAlpha);

} // namespace tetvdb
