// SPDX-License-Identifier: Apache-2.0
//
// Numbers into colours.
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

/// A path through colours. viridis, magma, plasma, inferno, cividis, turbo, coolwarm, grey; their
/// sources and licences are in ColorMapData.h.
class ColorMap {
public:
  /// Throws Error(Usage) for a name that is not there. A name that ends in "_r" is the map
  /// backward.
  static const ColorMap& named(std::string_view name);
  /// Without those backward.
  static const std::vector<std::string>& names();

  /// Between sRGB values (0xRRGGBB) at equal distances.
  explicit ColorMap(std::vector<std::uint32_t> points) : points_(std::move(points)) {}

  /// At t in [0, 1], clamped, as linear light: linear between the values in sRGB. Grey for what is
  /// no number.
  Rgb operator()(double t) const;

private:
  std::vector<std::uint32_t> points_;
};

/// Of what has no value.
Rgb colorOfNothing();

/// Colours of kinds, such as regions: easily told apart up to eight or so, then repeating with
/// other brightness; never two equal ones in a row.
Rgb colorOfKind(std::size_t kind);

/// What numbers mean which colours, and what a legend has to say about it.
struct ColorScale {
  const ColorMap* map = nullptr; ///< null: numbers count `kinds`
  double low = 0, high = 1;
  bool logarithmic = false; ///< both ends are above 0
  std::string title;
  std::vector<std::string> kinds; ///< names of numbers 0, 1, ...

  Rgb operator()(double value) const;
  /// Where a value lies between low (0) and high (1), not clamped.
  double position(double value) const;
};

/// Round numbers (1, 2 or 5 times a power of ten; powers of ten and their multiples of a
/// logarithmic scale) within [low, high], ascending, about `count` of them.
std::vector<double> ticks(const ColorScale& scale, int count);

/// A tick as short as it can be told from its neighbours: "0.25", "1.5e-07".
std::string tickText(double value);

} // namespace tetvdb
