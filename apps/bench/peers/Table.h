// SPDX-License-Identifier: Apache-2.0
//
// What was measured, as a Markdown table on standard output and as JSON.
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
  Times ours, peer;         ///< peer may be empty: ours alone
  double targetRatio = 0;   ///< peer / ours that is to be reached; 0: none
  double targetSeconds = 0; ///< of ours; 0: none
  double floorBytes = 0;    ///< that must be moved at least; 0: not said
  std::string note;
};

/// Prints the rows of a case as they come and keeps them for the report.
class Tables {
public:
  explicit Tables(double bandwidth) : bandwidth_(bandwidth) {}

  /// Begins a table; `about` is printed below the title.
  void begin(const std::string& name, const std::string& about);
  void add(const Row& row);
  /// A line of text between rows is printed after the table.
  void note(const std::string& text);
  /// Prints the table that is open.
  void end();

  const nlohmann::ordered_json& json() const { return json_; }

private:
  double bandwidth_; ///< bytes a second
  std::vector<std::vector<std::string>> lines_;
  std::vector<std::string> notes_;
  nlohmann::ordered_json json_ = nlohmann::ordered_json::array();
};

/// Aligned Markdown; the first line is the heading, columns but the first two are right-aligned.
std::string markdown(const std::vector<std::vector<std::string>>& lines);

/// "1.234 s", "12.3 ms".
std::string duration(double seconds);
/// "1.23 GB", "45.6 MB".
std::string size(double bytes);

} // namespace tetvdb::bench
