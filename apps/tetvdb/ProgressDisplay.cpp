// SPDX-License-Identifier: Apache-2.0
#include "ProgressDisplay.h"

#include "Streams.h"

#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <unistd.h>

namespace tetvdb::cli {
namespace {

constexpr int kBarWidth = 32;
constexpr int kPercentPerLine = 5;

// 43 as 45, 7 as 7: the precision of an estimate.
int rounded(double number) {
  return static_cast<int>(number < 20 ? std::ceil(number) : 5 * std::ceil(number / 5));
}

} // namespace

ProgressDisplay::Style ProgressDisplay::choose(bool quiet, bool verbose) {
  if (quiet)
    return Style::Nothing;
  if (::isatty(STDERR_FILENO) != 0)
    return Style::Bar;
  return verbose ? Style::Lines : Style::Nothing;
}

ProgressDisplay::ProgressDisplay(Style style, Progress& progress, TimeEstimate& estimate)
    : style_(style), estimate_(estimate) {
  if (style_ == Style::Nothing)
    return;
  progress.onReport([this](std::string_view stage, double fraction) { show(stage, fraction); });
}

void ProgressDisplay::show(std::string_view stage, double fraction) {
  estimate_.update(stage, fraction, secondsNow());
  const std::string left = timeLeftText(estimate_.left());
  const int percent = static_cast<int>(100 * estimate_.done());
  if (style_ == Style::Lines) {
    if (stage != stage_) {
      printMessage(stage);
      stage_ = stage;
      if (percent < percent_) // a job without a plan
        percent_ = 0;
    }
    if (percent >= percent_ + kPercentPerLine) {
      printMessage(fmt::format("{} {} %{}", stage, percent, left));
      percent_ = percent;
    }
    return;
  }
  const int full = static_cast<int>(estimate_.done() * kBarWidth);
  writeToStandardError(fmt::format("\r\033[K{:<11}[{:#<{}}{: <{}}] {:3} %{}", stage, "", full, "",
                                   kBarWidth - full, percent, left));
  drawn_ = true;
}

void ProgressDisplay::clear() {
  if (!drawn_)
    return;
  writeToStandardError("\r\033[K");
  drawn_ = false;
}

double secondsNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string timeLeftText(std::optional<double> seconds) {
  if (!seconds || !(*seconds < 100 * 3600.0))
    return "";
  if (*seconds < 60)
    return fmt::format(", about {} s left", rounded(*seconds));
  if (*seconds < 3600)
    return fmt::format(", about {} min left", rounded(*seconds / 60));
  return fmt::format(", about {} h left", rounded(*seconds / 3600));
}

} // namespace tetvdb::cli
