// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/core/TimeEstimate.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tetvdb::cli {

/// Options that every command has.
struct CommonOptions {
  std::string json;          ///< where the report goes: a path, "-" for stdout, empty for nowhere
  bool force = false;        ///< replace a file at `json` of any content
  bool allowOutside = false; ///< files that are read may refer to files outside of their folders
  bool quiet = false;
  bool verbose = false;
};

/// One run of a command: its options and services, and the results that the run loop prints.
struct Session {
  CommonOptions options;
  Report report;
  Progress progress;
  TimeEstimate estimate; ///< of the whole job: a command plans its stages before they begin

  /// Sections of the report in the order in which they are printed. "stages" is filled in by the
  /// run loop where a command has put a place for it.
  nlohmann::ordered_json sections = nlohmann::ordered_json::object();
  std::string text;                ///< the result for people, for stdout
  bool textIsSummary = false;      ///< -q leaves it out
  Status status = Status::Ok;      ///< Found if a comparison found differences
  std::vector<std::string> notes;  ///< lines for stderr with -v
  std::vector<std::string> errors; ///< lines for stderr from a command that went on after an error
};

} // namespace tetvdb::cli
