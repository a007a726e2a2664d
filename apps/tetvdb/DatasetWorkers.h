// SPDX-License-Identifier: Apache-2.0
//
// The models of a data set in child processes that may die.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/pipeline/dataset/DatasetRows.h"

#include <functional>
#include <vector>

namespace tetvdb::cli {

struct WorkerOptions {
  int count = 1;         ///< processes
  double maxSeconds = 0; ///< for one model
};

/// Hands `items` to as many processes, each this program once more with the arguments of this one
/// and --worker, and calls `take` with the row of each, in the order in which they end. A process
/// that crashes or takes longer than maxSeconds costs the model it works on, whose row says so; its
/// place is taken by a new one. Kills all of them when `progress` is cancelled, and throws what
/// Progress::check() does. Throws Error(Limit) where no process can be started.
void makeInWorkers(const std::vector<DatasetItem>& items, const WorkerOptions& options,
                   const std::function<void(const DatasetRow&)>& take, Progress& progress);

/// What such a process does: makes the items whose fields come from standard input, one at a time,
/// and writes a row for each to file descriptor 3, until the input ends. Ends with its parent.
void serveItems(const std::function<DatasetRow(const DatasetItem&)>& make);

} // namespace tetvdb::cli
