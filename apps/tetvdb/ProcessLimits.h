// SPDX-License-Identifier: Apache-2.0
//
// Applies --max-memory and --max-time to the whole process before it reads anything. The library
// refuses jobs whose need it can estimate. These limits apply to the rest: files that state wrong
// sizes, and libraries that cannot be cancelled.
#pragma once

#include "JobOptions.h"
#include "tetvdb/core/Progress.h"

namespace tetvdb::cli {

/// Bounds what this process allocates by --max-memory, with a quarter more for what the library
/// cannot foresee and with its threads' stacks; without it by what the machine has available.
/// Allocations beyond fail. Not with a GPU in the machine, whose driver reserves addresses, and not
/// in builds with sanitizers. Without --max-memory, heaps of threads grow by 64 MB at a time. Sets
/// the deadline of `progress` by --max-time and has the process end (RunLoop.h) where it goes on
/// for much longer. Throws Error(Usage).
void limitProcess(const JobOptions& options, Progress& progress);

} // namespace tetvdb::cli
