// SPDX-License-Identifier: Apache-2.0
#include "ParsePictures.h"

#include "ParseQuantities.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/visualize/Srgb.h"

#include <charconv>
#include <cmath>
#include <string_view>

namespace tetvdb::cli {
namespace {

// The whole of `text`.
template <typename Number>
bool parse(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

bool parseFinite(std::string_view text, double& number) {
  return parse(text, number) && std::isfinite(number);
}

bool parseColor(std::string_view text, Pixel& top, Pixel& bottom) {
  if (text == "sky") {
    const PictureOptions defaults;
    top = defaults.backgroundTop;
    bottom = defaults.backgroundBottom;
  } else if (text == "white" || text == "black") {
    const float light = text == "white" ? 1 : 0;
    top = bottom = {light, light, light, 1};
  } else if (text == "transparent") {
    top = bottom = {};
  } else {
    std::uint32_t hex = 0;
    if (text.size() != 7 || text[0] != '#')
      return false;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + 7, hex, 16);
    if (error != std::errc() || end != text.data() + 7)
      return false;
    top = bottom = opaque(rgbOfHex(hex));
  }
  return true;
}

} // namespace

Cut parseCut(const std::string& option, const std::string& text) {
  const std::string advice =
      "give an axis and a share of the box, x=0.5, or a coordinate with the unit u, x=12.5u";
  const std::string_view axes = "xyz";
  if (text.size() < 3 || axes.find(text[0]) == std::string_view::npos || text[1] != '=')
    refuse(option, text, advice);
  Cut cut;
  cut.axis = axes.find(text[0]);
  std::string_view value = std::string_view(text).substr(2);
  cut.inUnits = value.back() == 'u';
  if (cut.inUnits)
    value.remove_suffix(1);
  if (!parseFinite(value, cut.at) || (!cut.inUnits && (cut.at < 0 || cut.at > 1)))
    refuse(option, text, advice);
  return cut;
}

std::array<double, 2> parseRange(const std::string& option, const std::string& text) {
  const std::size_t colon = text.find(':');
  std::array<double, 2> range{};
  if (colon == std::string::npos || !parseFinite(text.substr(0, colon), range[0]) ||
      !parseFinite(text.substr(colon + 1), range[1]) || !(range[0] < range[1]))
    refuse(option, text, "give two numbers, the lower one first: 0:100");
  return range;
}

void parseSize(const std::string& option, const std::string& text, int& width, int& height) {
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos || !parse(std::string_view(text).substr(0, cross), width) ||
      !parse(std::string_view(text).substr(cross + 1), height) || width < 1 || height < 1 ||
      width > 65535 || height > 65535)
    refuse(option, text, "give width and height in pixels: 640x480");
}

void parseBackground(const std::string& option, const std::string& text, Pixel& top,
                     Pixel& bottom) {
  const std::string advice =
      "give sky, white, black, transparent, #RRGGBB, or two with a comma between them";
  const std::size_t comma = text.find(',');
  Pixel ignored;
  if (comma == std::string::npos) {
    if (!parseColor(text, top, bottom))
      refuse(option, text, advice);
  } else if (!parseColor(std::string_view(text).substr(0, comma), top, ignored) ||
             !parseColor(std::string_view(text).substr(comma + 1), ignored, bottom)) {
    refuse(option, text, advice);
  }
}

} // namespace tetvdb::cli
