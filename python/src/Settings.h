// SPDX-License-Identifier: Apache-2.0
//
// Keyword arguments into settings of jobs. Values of another type, or that a setting does not
// take, are Error(Usage) with the setting's name in backquotes. None is as good as nothing.
//
//   Settings settings(keywords);
//   settings.take("resolution", job.voxelize.resolution);
//   settings.finish();   // all were known
#pragma once

#include "RunJob.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/pipeline/RelativeLength.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cstdint>
#include <initializer_list>
#include <nanobind/nanobind.h>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb::python {

class Settings {
public:
  explicit Settings(nb::dict values) : values_(std::move(values)) {}

  /// Whether there is a value other than None. Counts the setting as known.
  bool has(const char* name);

  // Each leaves `value` as it is where nothing was given.
  void take(const char* name, bool& value);
  void take(const char* name, int& value);
  void take(const char* name, double& value); ///< finite
  /// A whole number from `low` to `high`, at most 2^53.
  void takeWhole(const char* name, std::uint64_t low, std::uint64_t high, std::uint64_t& value);
  void take(const char* name, std::string& value);
  /// A text with commas, or a sequence of texts and numbers.
  void take(const char* name, std::vector<std::string>& value);
  void takePoint(const char* name, Vec3d& value);
  /// Two finite numbers.
  void takePair(const char* name, std::vector<double>& value);
  /// A finite length above zero.
  void takeLength(const char* name, double& value);
  /// A number, or a text such as "1e-3d"; `voxels`: "0.5v" too.
  void takeRelative(const char* name, RelativeLength& value, bool voxels);
  /// One of the words, as its number in the list.
  template <typename Enum>
  void takeWord(const char* name, const std::vector<std::pair<const char*, Enum>>& words,
                Enum& value) {
    if (has(name))
      value = numberOfWord(name, textOf(name), words);
  }
  template <typename Enum>
  void takeWord(const char* name, std::initializer_list<std::pair<const char*, Enum>> words,
                Enum& value) {
    takeWord(name, std::vector<std::pair<const char*, Enum>>(words), value);
  }
  /// The number of `word`; refuses one that is not in the list.
  template <typename Enum>
  static Enum numberOfWord(const char* name, const std::string& word,
                           const std::vector<std::pair<const char*, Enum>>& words) {
    std::string known;
    for (const auto& [text, number] : words) {
      if (word == text)
        return number;
      known += (known.empty() ? "" : ", ") + std::string(text);
    }
    refuse(name, "'" + word + "' is none of its values", "choose from " + known);
  }

  /// `threads`, `max_memory` and `max_time`.
  JobLimits takeLimits();
  /// `voxel_size` and `resolution`.
  void takeSize(Vec3d& voxelSize, int& resolution);
  /// `weld` and `keep_orientation`.
  void takeCleaning(CleanOptions& clean);
  /// `inside` and `shell`.
  void takeInside(SolidOptions& solid);

  /// Throws TypeError for a setting that was not asked for.
  void finish();
  /// The limits, threads and memory into `job`; then finish().
  template <typename Job>
  JobLimits finish(Job& job) {
    const JobLimits limits = takeLimits();
    finish();
    job.threads = limits.threads;
    job.maxMemory = limits.maxMemory;
    return limits;
  }

  nb::object get(const char* name) const;
  [[noreturn]] static void refuse(const char* name, const std::string& what,
                                  const std::string& advice);

private:
  std::string textOf(const char* name) const;
  double numberOf(const char* name) const;

  nb::dict values_;
  std::vector<std::string> known_;
};

} // namespace tetvdb::python
