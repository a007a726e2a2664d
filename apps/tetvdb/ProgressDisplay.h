// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"

#include <string>
#include <string_view>

namespace tetvdb::cli {

/// Shows on stderr how far a job is: a bar on a terminal, else when asked for lines that programs
/// can follow, "tetvdb: STAGE" and "tetvdb: STAGE 40 %".
class ProgressDisplay {
public:
  enum class Style { Nothing, Lines, Bar };

  /// Lines with `verbose`, a bar where stderr is a terminal, nothing with `quiet`.
  static Style choose(bool quiet, bool verbose);

  ProgressDisplay(Style style, Progress& progress);
  ~ProgressDisplay() { clear(); }
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  /// Wipes the bar, so that other lines can be printed.
  void clear();

private:
  void show(std::string_view stage, double fraction);

  Style style_;
  bool drawn_ = false;
  std::string stage_;
  int percent_ = 0; ///< of the last line
};

} // namespace tetvdb::cli
