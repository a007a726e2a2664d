// SPDX-License-Identifier: Apache-2.0
//
// Colours of numbers.
//
//   const tetvdb::ColorMap& map = tetvdb::ColorMap::named("viridis");
//   const tetvdb::Rgb color = map(0.5);
#pragma once

#include "tetvdb/visualize/Drawable.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// A sequence of colours, with linear interpolation. viridis, magma, plasma, inferno, cividis,
/// turbo, coolwarm, grey; their sources and licences are in ColorMapData.h.
class ColorMap {
public:
  /// Throws Error(Usage) for an unknown name. A name that ends in "_r" is the reversed map.
  static const ColorMap& named(std::string_view name);
  /// Without the reversed ones.
  static const std::vector<std::string>& names();

  /// Between sRGB values (0xRRGGBB) at equal distances.
  explicit ColorMap(std::vector<std::uint32_t> points) : points_(std::move(points)) {}

  /// At t in [0, 1], clamped, as linear light: linear between the values in sRGB. Grey for NaN.
  Rgb operator()(double t) const;

private:
  std::vector<std::uint32_t> points_;
};

/// The colour of missing values.
Rgb colorOfNothing();

/// Colours of kinds, such as regions: clearly different up to about eight, then repeated with other
/// brightness; successive ones are never equal.
Rgb colorOfKind(std::size_t kind);

/// The colours of numbers, and the texts of a legend.
struct ColorScale {
  const ColorMap* map = nullptr; ///< null: numbers count `kinds`
  double low = 0, high = 1;
  bool logarithmic = false; ///< low and high are above 0
  std::string title;
  std::vector<std::string> kinds; ///< names of numbers 0, 1, ...

  Rgb operator()(double value) const;
  /// Where a value lies between low (0) and high (1), not clamped.
  double position(double value) const;
};

/// Round numbers (1, 2 or 5 times a power of ten; powers of ten and their multiples of a
/// logarithmic scale) within [low, high], ascending, about `count` of them.
std::vector<double> ticks(const ColorScale& scale, int count);

/// The shortest text that tells a tick from its neighbours: "0.25", "1.5e-07".
std::string tickText(double value);

} // namespace tetvdb
