// SPDX-License-Identifier: Apache-2.0
#include "NumberText.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

constexpr int kDigits = 7;

std::string coordinateText(double value, double extent) {
  if (!(extent > 0) || !std::isfinite(extent) || !std::isfinite(value))
    return fmt::format("{:.7g}", value);
  // Rounded to a power of ten, which is exact where it is a whole number or its inverse is.
  const int digits = kDigits - 1 - static_cast<int>(std::floor(std::log10(extent)));
  const double unit = std::pow(10.0, std::abs(digits));
  const double rounded =
      digits >= 0 ? std::round(value * unit) / unit : std::round(value / unit) * unit;
  return fmt::format("{:.15g}", std::isfinite(rounded) ? rounded + 0.0 : value); // no "-0"
}

} // namespace

std::string bytesText(std::uint64_t bytes) {
  if (bytes < 1000)
    return fmt::format("{} bytes", bytes);
  double number = static_cast<double>(bytes);
  for (const char* unit : {"kB", "MB", "GB"}) {
    number /= 1000;
    if (number < 999.5)
      return fmt::format("{:.{}f} {}", number, number < 9.995 ? 2 : number < 99.95 ? 1 : 0, unit);
  }
  return fmt::format("{:.2f} TB", number / 1000);
}

std::string lengthText(double length) {
  return fmt::format("{:.7g}", length);
}

std::string lengthText(const Vec3d& lengths) {
  if (lengths[0] == lengths[1] && lengths[1] == lengths[2])
    return lengthText(lengths[0]);
  return fmt::format("{:.7g} x {:.7g} x {:.7g}", lengths[0], lengths[1], lengths[2]);
}

std::string pointText(const Vec3d& point, double extent) {
  return fmt::format("({}, {}, {})", coordinateText(point[0], extent),
                     coordinateText(point[1], extent), coordinateText(point[2], extent));
}

double extentOf(const Vec3d& low, const Vec3d& high) {
  return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
}

} // namespace tetvdb::cli
