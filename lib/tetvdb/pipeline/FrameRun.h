// SPDX-License-Identifier: Apache-2.0
//
// What jobs over the frames of a sequence share. Internal.
#pragma once

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

/// Calls work(i, progress) for every frame: the first alone, to measure the memory of one, then as
/// many at the same time as threads allow and fit in `maxMemory` bytes (0: the available memory) by
/// what the process has taken so far, each with its share of the arena's threads. Returns how many.
/// The first failure ends all; an Error is thrown with the frame's name. `progress` counts frames.
std::size_t forEachFrame(const std::vector<Frame>& frames, std::size_t maxMemory,
                         Progress& progress,
                         const std::function<void(std::size_t i, Progress&)>& work);

/// Adds the frames' reports to `report`: stages summed by name, and warnings once each, with the
/// first frame that has it, but for those of the code `leftOut`.
void addReports(const std::vector<Report>& reports, const std::vector<Frame>& frames,
                const std::string& leftOut, Report& report);

} // namespace tetvdb
