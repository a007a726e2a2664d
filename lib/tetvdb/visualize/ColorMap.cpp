// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/ColorMap.h"

#include "tetvdb/core/ClosestName.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/visualize/ColorMapData.h"
#include "tetvdb/visualize/Srgb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <map>

namespace tetvdb {
namespace {

template <std::size_t N>
std::vector<std::uint32_t> pointsOf(const std::uint32_t (&points)[N]) {
  return {std::begin(points), std::end(points)};
}

using Maps = std::map<std::string, ColorMap, std::less<>>;

Maps makeMaps() {
  namespace data = color_map_data;
  const std::vector<std::pair<std::string, std::vector<std::uint32_t>>> forward = {
      {"viridis", pointsOf(data::kViridis)},   {"magma", pointsOf(data::kMagma)},
      {"plasma", pointsOf(data::kPlasma)},     {"inferno", pointsOf(data::kInferno)},
      {"cividis", pointsOf(data::kCividis)},   {"turbo", pointsOf(data::kTurbo)},
      {"coolwarm", pointsOf(data::kCoolwarm)}, {"grey", {0x000000, 0xFFFFFF}}};
  Maps maps;
  for (const auto& [name, points] : forward) {
    maps.emplace(name, ColorMap(points));
    maps.emplace(name + "_r", ColorMap({points.rbegin(), points.rend()}));
  }
  return maps;
}

} // namespace

const std::vector<std::string>& ColorMap::names() {
  static const std::vector<std::string> names = {"viridis", "magma", "plasma",   "inferno",
                                                 "cividis", "turbo", "coolwarm", "grey"};
  return names;
}

const ColorMap& ColorMap::named(std::string_view name) {
  static const Maps maps = makeMaps();
  const auto found = maps.find(name);
  if (found == maps.end())
    throw Error(Status::Usage, "", fmt::format("'{}' is no colour map", name),
                suggestName(name, names(),
                            fmt::format("there are {}, and each backward with _r",
                                        fmt::join(names(), ", "))));
  return found->second;
}

Rgb ColorMap::operator()(double t) const {
  if (std::isnan(t))
    return colorOfNothing();
  const double at = std::clamp(t, 0.0, 1.0) * static_cast<double>(points_.size() - 1);
  const std::size_t first = std::min(static_cast<std::size_t>(at), points_.size() - 2);
  const auto share = static_cast<float>(at - static_cast<double>(first));
  Rgb rgb;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto a = static_cast<float>(points_[first] >> (16 - 8 * c) & 0xFF);
    const auto b = static_cast<float>(points_[first + 1] >> (16 - 8 * c) & 0xFF);
    rgb[c] = linearOfSrgb((a + share * (b - a)) / 255);
  }
  return rgb;
}

Rgb colorOfNothing() {
  return rgbOfHex(0x808080);
}

Rgb colorOfKind(std::size_t kind) {
  // M. Okabe, K. Ito, "Color Universal Design" (2008): told apart by every kind of eyes.
  constexpr std::array<std::uint32_t, 8> kColors = {0x56B4E9, 0xE69F00, 0x009E73, 0xF0E442,
                                                    0xCC79A7, 0x0072B2, 0xD55E00, 0xB0B0B0};
  constexpr std::array<float, 3> kBrightness = {1, 0.55F, 0.3F};
  Rgb rgb = rgbOfHex(kColors[kind % kColors.size()]);
  for (float& channel : rgb)
    channel *= kBrightness[kind / kColors.size() % kBrightness.size()];
  return rgb;
}

double ColorScale::position(double value) const {
  if (logarithmic)
    return value > 0 || std::isnan(value) ? std::log(value / low) / std::log(high / low)
                                          : -std::numeric_limits<double>::infinity();
  return high > low ? (value - low) / (high - low) : value == low ? 0.5 : value > low;
}

Rgb ColorScale::operator()(double value) const {
  if (map != nullptr)
    return (*map)(position(value));
  return value >= 0 ? colorOfKind(static_cast<std::size_t>(value)) : colorOfNothing();
}

std::vector<double> ticks(const ColorScale& scale, int count) {
  std::vector<double> result;
  const double low = scale.low, high = scale.high;
  if (!(high > low) || count < 2)
    return {low};
  if (scale.logarithmic) {
    const double decades = std::log10(high / low);
    for (int power = static_cast<int>(std::floor(std::log10(low))); power <= std::log10(high);
         ++power)
      for (const int multiple : {1, 2, 3, 5}) {
        const bool wanted =
            multiple == 1 || (decades <= count / 2.0 && multiple != 3) || decades <= count / 4.0;
        const double value = multiple * std::pow(10.0, power);
        if (wanted && value >= low * (1 - 1e-12) && value <= high * (1 + 1e-12))
          result.push_back(value);
      }
    if (result.size() >= 2)
      return result;
    result.clear();
  }
  const double rough = (high - low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double multiple : {1.0, 2.0, 5.0})
    if (multiple * power >= rough * (1 - 1e-12)) {
      step = multiple * power;
      break;
    }
  const double room = (high - low) * 1e-9;
  for (double number = std::ceil((low - room) / step); number * step <= high + room; ++number)
    result.push_back(number == 0 ? 0 : number * step); // no -0
  return result;
}

std::string tickText(double value) {
  return fmt::format("{:.6g}", value);
}

} // namespace tetvdb
