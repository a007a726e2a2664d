// SPDX-License-Identifier: Apache-2.0
#include "ProgressDisplay.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace tetvdb::cli {
namespace {

constexpr int kBarWidth = 32;
constexpr int kPercentPerLine = 5;

} // namespace

ProgressDisplay::Style ProgressDisplay::choose(bool quiet, bool verbose) {
  if (quiet)
    return Style::Nothing;
  if (::isatty(STDERR_FILENO) != 0)
    return Style::Bar;
  return verbose ? Style::Lines : Style::Nothing;
}

ProgressDisplay::ProgressDisplay(Style style, Progress& progress) : style_(style) {
  if (style_ == Style::Nothing)
    return;
  progress.onReport([this](std::string_view stage, double fraction) { show(stage, fraction); });
}

void ProgressDisplay::show(std::string_view stage, double fraction) {
  fraction = std::clamp(fraction, 0.0, 1.0);
  if (style_ == Style::Lines) {
    const int percent = static_cast<int>(100 * fraction);
    if (stage != stage_) {
      fmt::print(stderr, "tetvdb: {}\n", stage);
      stage_ = stage;
      percent_ = 0;
    } else if (percent >= percent_ + kPercentPerLine) {
      fmt::print(stderr, "tetvdb: {} {} %\n", stage, percent);
      percent_ = percent;
    }
    return;
  }
  const int full = static_cast<int>(fraction * kBarWidth);
  fmt::print(stderr, "\r\033[K{:<11}[{:#<{}}{: <{}}] {:3.0f} %", stage, "", full, "",
             kBarWidth - full, 100 * fraction);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressDisplay::clear() {
  if (!drawn_)
    return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

} // namespace tetvdb::cli
