// SPDX-License-Identifier: Apache-2.0
//
// What jobs over the frames of a sequence share. Internal.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/FindFrames.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace tetvdb {

/// "frame 3 (run.exo, step 2)" of the frame at `i`, counted from 0.
std::string frameTitle(const Frame& frame, std::size_t i);

/// An error in the frame at `i`, which it names.
Error inFrame(const Error& error, const Frame& frame, std::size_t i);

/// Progress of one frame: it stops when the whole job stops.
class FrameProgress {
public:
  explicit FrameProgress(Progress& whole);
  Progress& progress() { return own_; }

private:
  Progress own_;
};

/// How many frames fit in memory at the same time, by the memory of the process so far, which is at
/// least that of one frame. `maxMemory`: bytes; 0: the available memory.
std::size_t framesAtOnce(std::size_t maxMemory);

/// Calls work(i) for i in [begin, end) from `workers` threads at most, each with its share of the
/// arena's threads. The first failure ends all, and its exception is thrown.
void forFrames(std::size_t begin, std::size_t end, std::size_t workers,
               const std::function<void(std::size_t)>& work);

/// Adds the frames' reports to `report`: stages summed by name, and warnings once each, with the
/// first frame that has it, but for those of the code `leftOut`.
void addReports(const std::vector<Report>& reports, const std::vector<Frame>& frames,
                const std::string& leftOut, Report& report);

} // namespace tetvdb
