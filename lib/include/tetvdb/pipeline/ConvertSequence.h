// SPDX-License-Identifier: Apache-2.0
//
// Writes the frames of a sequence in another format.
//
//   const auto frames = tetvdb::findFrames({"run_*.vti"}, {}, false, report, progress);
//   job.output = "run.vdb"; // run.0001.vdb and so on
//   auto files = tetvdb::convertSequence(job, frames, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/ConvertJob.h"
#include "tetvdb/pipeline/FindFrames.h"
#include "tetvdb/pipeline/SequenceJob.h"

#include <vector>

namespace tetvdb {

/// Runs `job` for every frame: job.input, job.isVolume and job.timeStep are the frame's, job.output
/// "a.vdb" becomes "a.0001.vdb" and so on, consecutive from 1. The first frame is converted alone
/// to measure the memory of one, the others at the same time as far as threads and memory allow,
/// with a maxMemory one by one. Arrays that have no voxel but the background become empty grids.
/// Array files get the box of all frames, which a first pass finds, unless the transforms differ
/// (the warning "sequence-transform"). Frames whose grids are of other names or types than the
/// first frame's cause the warning "sequence-grids". Adds the stages of all frames, summed, to
/// `report`, and each warning once, with the first frame that has it. Throws the errors of run(),
/// with the frame's name; frames finished until then are kept. Error(Usage) for tiles, and for
/// frames of several files.
std::vector<FrameResult> convertSequence(const ConvertJob& job, const std::vector<Frame>& frames,
                                         Report& report, Progress& progress);

} // namespace tetvdb
