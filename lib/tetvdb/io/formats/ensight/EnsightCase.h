// SPDX-License-Identifier: Apache-2.0
//
// The text file of an EnSight Gold mesh (.case), which names the files of the geometry and the
// variables of every step.
#pragma once

#include "tetvdb/io/source/Source.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb::ensight {

/// Times of a set, and the numbers in the file names of its steps.
struct TimeSet {
  std::int64_t id = 1;
  std::vector<double> times;
  std::vector<std::int64_t> fileNumbers; ///< as many as times
};

/// A file name of the case, with '*' for a step's number.
struct FilePattern {
  std::string name;
  std::int64_t timeSet = -1; ///< -1: the same for all steps
};

struct Variable {
  std::string name;
  bool onElements = false;
  std::uint32_t components = 1; ///< 1, 3, 6 (symmetric tensors) or 9
  FilePattern file;
};

struct Case {
  FilePattern geometry;
  std::vector<Variable> variables;
  std::vector<std::string> otherVariables; ///< kinds that are not supported, "complex scalar per
                                           ///< node"
  std::vector<TimeSet> timeSets;

  /// The times of the steps: those of all time sets in use, ascending, without repetition.
  std::vector<double> times() const;
  /// The path of a pattern's file at the time of step `step`: the last of its set that is not after
  /// that time. Throws Error(Invalid) if it is outside the case's folder.
  std::string pathOf(const FilePattern& pattern, std::size_t step, const std::string& path) const;
};

/// Throws Error(Invalid) with the line for other text than a case of EnSight Gold, for files of
/// several steps in one ("FILE" sections) and for more steps than the text can name.
Case parseCase(const Source& source);

} // namespace tetvdb::ensight
