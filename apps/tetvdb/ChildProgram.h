// SPDX-License-Identifier: Apache-2.0
//
// Runs this program as a child process, so that a model that crashes it does not affect the others.
#pragma once

#include "tetvdb/core/Progress.h"

#include <cstddef>
#include <functional>
#include <spawn.h>
#include <string>
#include <sys/types.h>
#include <vector>

namespace tetvdb::cli {

/// How a child ended.
struct ChildEnd {
  int status = -1; ///< its exit status, 128 + the signal that ended it, or -1: not started
  double seconds = 0;
  std::size_t peakBytes = 0; ///< highest resident memory
};

/// Starts this very program with `words`, its own name first; its output is discarded. `addFiles`
/// sets its other descriptors. Returns 0, or errno if it fails. The child is cancelled when the
/// calling thread ends (endWithParent()).
int startThisProgram(std::vector<std::string> words,
                     const std::function<void(posix_spawn_file_actions_t&)>& addFiles,
                     pid_t& child);

/// In a child that startThisProgram() has started: `signal` when its parent ends, also by SIGKILL.
/// Returns false, and does nothing, in other processes and where the parent has ended already.
bool endWithParent(int signal);

/// Runs this very program with `arguments`; what it prints is thrown away. Kills it when `progress`
/// is cancelled (and throws what Progress::check() does) or after `maxSeconds`.
ChildEnd runThisProgram(const std::vector<std::string>& arguments, double maxSeconds,
                        const Progress& progress);

} // namespace tetvdb::cli
