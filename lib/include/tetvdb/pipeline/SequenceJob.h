// SPDX-License-Identifier: Apache-2.0
//
// Converts frames to a sequence of volumes with one transform and consecutive numbers.
//
//   const auto frames = tetvdb::findFrames({"run.pvd"}, {}, false, report, progress);
//   tetvdb::SequenceResult result = tetvdb::runSequence(job, frames, {}, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/FindFrames.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

struct SequenceOptions {
  /// false: skips a frame whose file exists from an earlier run with the same input, options and
  /// version. Only .vdb files store this information.
  bool again = false;
};

struct FrameResult {
  Frame frame;
  OutputInfo output;
  bool skipped = false;        ///< it existed
  std::vector<GridInfo> grids; ///< empty for skipped frames
};

struct SequenceResult {
  std::vector<FrameResult> frames;
  GridTransform transform; ///< of all frames
  std::size_t atOnce = 1;  ///< frames processed at the same time
};

/// Runs `job` for every frame: job.inputs are the frame's, job.output "a.vdb" becomes "a.0001.vdb"
/// and so on, consecutive from 1 for any numbers or times of the input. A first pass reads every
/// frame for its box, its arrays and their ranges; the resolution counts along the box of all
/// frames, and ranges to be remapped are those of all frames. Nothing is written unless all frames
/// can be read and have the arrays of the first one. The first frame is processed alone to measure
/// the memory per frame; the others are processed in parallel as far as threads and memory allow. A
/// frame's file depends on its input and the options only. Each file's metadata has "frame",
/// "frames", "time" (if the input has it) and "job", by which a later run recognises a finished
/// frame.
///
/// Adds stages "read" (the first pass) and those of the frames, summed, to `report`. A warning of
/// several frames is given once and names the first of them; "hidden-values" is assessed over the
/// values of all frames. Throws the errors of run(), with the frame's name; frames finished until
/// then are kept, and a later run continues from there. Error(Invalid) for arrays that differ
/// between frames; Error(Usage) for job.meshOutput, which applies to one mesh.
SequenceResult runSequence(const VoxelizeJob& job, const std::vector<Frame>& frames,
                           const SequenceOptions& options, Report& report, Progress& progress);

} // namespace tetvdb
