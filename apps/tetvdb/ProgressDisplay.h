// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/TimeEstimate.h"

#include <optional>
#include <string>
#include <string_view>

namespace tetvdb::cli {

/// Shows on stderr the progress of a whole job, and its estimated remaining time if that is known:
/// a bar on a terminal, else if requested lines that programs can parse, "tetvdb: STAGE" as a stage
/// begins and "tetvdb: STAGE 40 %" or "tetvdb: STAGE 40 %, about 30 s left" of the whole.
class ProgressDisplay {
public:
  enum class Style { Nothing, Lines, Bar };

  /// Lines with `verbose`, a bar where stderr is a terminal, nothing with `quiet`.
  static Style choose(bool quiet, bool verbose);

  /// `estimate` outlives it; stages may be planned until the first of them begins.
  ProgressDisplay(Style style, Progress& progress, TimeEstimate& estimate);
  ~ProgressDisplay() { clear(); }
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  /// Clears the bar, so that other lines can be printed.
  void clear();

private:
  void show(std::string_view stage, double fraction);

  Style style_;
  TimeEstimate& estimate_;
  bool drawn_ = false;
  std::string stage_;
  int percent_ = 0; ///< of the last line
};

/// The time of the clock that all estimates here use.
double secondsNow();

/// ", about 40 s left", with at most two significant digits; empty if it is not known.
std::string timeLeftText(std::optional<double> seconds);

} // namespace tetvdb::cli
