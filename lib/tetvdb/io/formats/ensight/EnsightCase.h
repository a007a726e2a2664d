// SPDX-License-Identifier: Apache-2.0
//
// The text file of an EnSight Gold mesh (.case), which names the files of the geometry and the
// variables of every step.
#pragma once

#include "tetvdb/io/source/Source.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb::ensight {

/// Times of a set, and the numbers in the file names of its steps.
struct TimeSet {
  std::int64_t id = 1;
  std::vector<double> times;
  std::vector<std::int64_t> fileNumbers; ///< as many as times
};

/// Files that hold several steps, one after the other.
struct FileSet {
  struct File {
    std::optional<std::int64_t> index; ///< the number in its name
    std::int64_t steps = 0;
  };
  std::int64_t id = 1;
  std::vector<File> files;
};

/// A file name of the case, with '*' for a step's number.
struct FilePattern {
  std::string name;
  std::int64_t timeSet = -1; ///< -1: the same for all steps
  std::int64_t fileSet = -1; ///< -1: a file for each step
};

/// Where the data of a step are.
struct StepPlace {
  std::string path;
  std::optional<std::size_t> number; ///< of the step, in a file that holds several
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
  std::vector<FileSet> fileSets;

  /// The times of the steps: those of all time sets in use, ascending, without repetition.
  std::vector<double> times() const;
  /// A pattern's data at the time of step `step`: the last of its set that are not after that time.
  /// `path`: of the case. Throws Error(Invalid) for files outside the case's folder.
  StepPlace placeOf(const FilePattern& pattern, std::size_t step, const std::string& path) const;
};

/// Throws Error(Invalid) with the line for other text than a case of EnSight Gold and for more
/// steps than the text can name.
Case parseCase(const Source& source);

} // namespace tetvdb::ensight
