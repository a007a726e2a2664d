// SPDX-License-Identifier: Apache-2.0
#include "Table.h"

#include <algorithm>
#include <fmt/format.h>

namespace tetvdb::bench {

std::string duration(double seconds) {
  if (seconds >= 100)
    return fmt::format("{:.0f} s", seconds);
  if (seconds >= 1)
    return fmt::format("{:.2f} s", seconds);
  return seconds >= 0.01 ? fmt::format("{:.0f} ms", seconds * 1e3)
                         : fmt::format("{:.2f} ms", seconds * 1e3);
}

std::string size(double bytes) {
  return bytes >= 1e9 ? fmt::format("{:.2f} GB", bytes * 1e-9)
                      : fmt::format("{:.1f} MB", bytes * 1e-6);
}

std::string markdown(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths(lines.front().size(), 3);
  for (const auto& line : lines)
    for (std::size_t k = 0; k < line.size(); ++k)
      widths[k] = std::max(widths[k], line[k].size());
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t k = 0; k < lines[i].size(); ++k)
      text += k < 2 ? fmt::format("| {:<{}} ", lines[i][k], widths[k])
                    : fmt::format("| {:>{}} ", lines[i][k], widths[k]);
    text += "|\n";
    if (i > 0)
      continue;
    for (std::size_t k = 0; k < widths.size(); ++k)
      text += '|' + std::string(widths[k] + 1, '-') + (k < 2 ? '-' : ':');
    text += "|\n";
  }
  return text;
}

} // namespace tetvdb::bench
