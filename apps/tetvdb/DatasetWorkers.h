// SPDX-License-Identifier: Apache-2.0
//
// Processes the models of a data set in child processes, which may crash.
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

/// Distributes `items` to as many processes, each of which is this program with the same arguments
/// and --worker, and calls `take` with the row of each item, in the order in which they end. If a
/// process crashes or takes longer than maxSeconds, the row of its model says so, and a new process
/// replaces it. Kills all of them when `progress` is cancelled, and throws what Progress::check()
/// does. Throws Error(Limit) where no process can be started.
void makeInWorkers(const std::vector<DatasetItem>& items, const WorkerOptions& options,
                   const std::function<void(const DatasetRow&)>& take, Progress& progress);

/// The work of such a process: makes the items whose fields come from standard input, one at a
/// time, and writes a row for each to file descriptor 3, until the input ends. Ends with its
/// parent.
void serveItems(const std::function<DatasetRow(const DatasetItem&)>& make);

} // namespace tetvdb::cli
