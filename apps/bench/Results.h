// SPDX-License-Identifier: Apache-2.0
//
// The measurements: rows by case, printed at once and kept as JSON.
#pragma once

#include "Measure.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tetvdb::bench {

/// Ours against one peer.
struct Row {
  std::string what; ///< "mask, 10^6 tets, 256^3"
  std::string peerName;
  Times ours, peer;           ///< peer may be empty: ours alone
  double targetRatio = 0;     ///< peer / ours that is to be reached; 0: none
  double targetSeconds = 0;   ///< of ours; 0: none
  double floorBytes = 0;      ///< that must be moved at least; 0: not said
  double peakBytes = 0;       ///< memory of ours as a process; 0: not measured
  double peerPeakBytes = 0;   ///< the same of the peer
  double targetBytes = 0;     ///< that ours may take; 0: none
  double targetLessBytes = 0; ///< peer's memory / ours that is to be reached; 0: none
  std::string note;
  /// Where a case is drawn as curves: which one this row is a point of, and its place along it.
  std::string curve, peerCurve;
  double at = 0;
};

/// Prints each row of a case and keeps it.
class Tables {
public:
  /// `bandwidth`, bytes a second: what floors are computed from.
  explicit Tables(double bandwidth) : bandwidth_(bandwidth) {}

  /// Begins a case; `about` is printed below the title. `along` is what Row::at counts where the
  /// case is drawn as curves.
  void begin(const std::string& name, const std::string& about, const std::string& along = "");
  void add(const Row& row);
  /// A line of text between rows is printed after the table.
  void note(const std::string& text);
  /// Prints the table that is open.
  void end();

  /// Of every case: case, about, along, rows with all single times in seconds, notes.
  const nlohmann::ordered_json& json() const { return json_; }

private:
  double bandwidth_;
  nlohmann::ordered_json json_ = nlohmann::ordered_json::array();
};

/// A case's rows as lines of a table, the heading first; columns that no row fills are left out.
std::vector<std::vector<std::string>> tableOf(const nlohmann::ordered_json& entry);

/// What a row was asked for and whether that was reached, one for each target.
struct Target {
  std::string asked, ours, peer, ratio;
  bool reached = false;
};
std::vector<Target> targetsOf(const nlohmann::ordered_json& row);

} // namespace tetvdb::bench
