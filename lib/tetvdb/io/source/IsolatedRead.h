// SPDX-License-Identifier: Apache-2.0
//
// Reads by a library that crashes on damaged files.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/CellMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace tetvdb {

/// Calls `read` in a child process and returns its mesh; its warnings and `partial` go to `report`.
/// An Error that it throws is thrown here; where the child dies, Error(Invalid) for `path`, where
/// it runs out of memory Error(Limit). The child has a Progress of its own and is killed when
/// `progress` is cancelled. `read` must not need other threads; it can read files and nothing else
/// of the system (io/source/Sandbox.h).
CellMesh readIsolated(const std::function<CellMesh(Report&, Progress&)>& read,
                      const std::string& path, Report& report, Progress& progress);

/// Limits of a child; Error(Limit) beyond.
struct IsolationLimits {
  /// Bytes beyond what this process has, never more than 3/4 of the free; 0: these.
  std::uint64_t memory = 0;
  unsigned seconds = 0; ///< of processor time; 0: no limit
};

/// For reading files of so many bytes, which may be compressed.
inline IsolationLimits limitsForBytes(double bytes) {
  return {(std::uint64_t(2) << 30) + static_cast<std::uint64_t>(40 * bytes),
          60 + static_cast<unsigned>(bytes / 5e6 < 1e6 ? bytes / 5e6 : 1e6)};
}

/// Arrays of numbers of any purpose.
using NumberArrays = std::vector<Attribute::Values>;

/// The same for arrays of numbers, with limits. Their content is not checked.
NumberArrays readArraysIsolated(const std::function<NumberArrays(Report&, Progress&)>& read,
                                const std::string& path, const IsolationLimits& limits,
                                Report& report, Progress& progress);

/// The same for the times of a file's steps.
std::vector<double>
readTimesIsolated(const std::function<std::vector<double>(Report&, Progress&)>& read,
                  const std::string& path, Report& report, Progress& progress);

/// The same for a yes-or-no question.
bool answerIsolated(const std::function<bool(Report&, Progress&)>& ask, const std::string& path,
                    Report& report, Progress& progress);

/// The same for triangles, with limits.
TriangleMesh readTrianglesIsolated(const std::function<TriangleMesh(Report&, Progress&)>& read,
                                   const std::string& path, const IsolationLimits& limits,
                                   Report& report, Progress& progress);

} // namespace tetvdb
