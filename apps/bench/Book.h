// SPDX-License-Identifier: Apache-2.0
//
// The benchmark book: for every case a page, its plot and its numbers, and a page of all targets.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace tetvdb::bench {

/// Of one case: `entry` as Tables::json() has it, how it was run and on what.
struct Chapter {
  nlohmann::ordered_json entry;
  std::string title;              ///< "mask and density against the paper's loop"
  std::string command;            ///< that makes this page
  nlohmann::ordered_json machine; ///< describeMachine()
  int threads = 0;
  double bandwidth = 0; ///< bytes a second
  double seconds = 0;   ///< that the case took
  double otherWork = 0; ///< of others meanwhile, in cores
};

/// Writes NAME.md, NAME.svg and NAME.json in `folder`. Throws
/// std::runtime_error where that cannot be done.
void writeChapter(const std::string& folder, const Chapter& chapter);

/// Writes targets.md from every chapter whose JSON lies in `folder`.
void writeTargets(const std::string& folder);

} // namespace tetvdb::bench
