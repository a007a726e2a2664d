// SPDX-License-Identifier: Apache-2.0
//
// What a job did and how long each stage took. The command line prints it as JSON.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// A step within a stage.
struct StagePart {
  std::string name;
  double seconds = 0;
};

/// One of `read`, `clean`, `check`, `tetrahedralize`, `voxelize`, `fields`, `extract`, `upload`,
/// `holes`, `download`, `write`.
struct Stage {
  std::string name;
  double seconds = 0;
  std::size_t peakBytes = 0; ///< highest resident memory of the process until the stage's end
  std::vector<StagePart> parts;
};

/// A warning; `code` is stable and short ("flipped-tets"), `text` one
/// sentence.
struct Warning {
  std::string code;
  std::string text;
};

/// Filled by the functions that a job calls. Not thread-safe: a job owns its report.
struct Report {
  std::vector<Stage> stages;
  std::vector<Warning> warnings;
  bool partial = false; ///< a promise was not met: exit status 1

  void warn(std::string_view code, std::string_view text) {
    warnings.push_back({std::string(code), std::string(text)});
  }
};

/// Highest resident memory of this process so far, in bytes; 0 where it is not known.
std::size_t peakResidentBytes();
/// Memory that this process can still take without swapping, in bytes: the minimum of what the
/// system has available, the control group's limit and the address-space limit.
std::size_t availableBytes();

/// Times a stage, and the parts within it, from construction to destruction.
class StageTimer {
public:
  StageTimer(Report& report, std::string_view name);
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

  /// Ends the part that is running and begins another.
  void part(std::string_view name);

private:
  using Clock = std::chrono::steady_clock;
  void endPart(Clock::time_point now);

  Report& report_;
  Stage stage_;
  Clock::time_point start_;
  Clock::time_point partStart_;
};

} // namespace tetvdb
