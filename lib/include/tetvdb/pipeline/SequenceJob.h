// SPDX-License-Identifier: Apache-2.0
//
// Many frames into as many volumes that play: one transform, contiguous names.
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
  /// false: a frame whose file is there from an earlier run with the same input, options and
  /// version is skipped. Only .vdb files can tell.
  bool again = false;
};

struct FrameResult {
  Frame frame;
  OutputInfo output;
  bool skipped = false;        ///< it was there
  std::vector<GridInfo> grids; ///< of skipped frames empty
};

struct SequenceResult {
  std::vector<FrameResult> frames;
  GridTransform transform; ///< of all frames
  std::size_t atOnce = 1;  ///< frames that were worked on at the same time
};

/// Runs `job` for every frame: job.inputs are the frame's, job.output "a.vdb" becomes "a.0001.vdb"
/// and so on, contiguous from 1 whatever numbers or times the input has. A first pass reads every
/// frame for its box, the ranges of its arrays and what arrays there are; the resolution counts
/// along the box of all frames, and ranges to be remapped are those of all frames. Nothing is
/// written unless all frames can be read and have the arrays that the first one has.
/// The first frame is made alone and shows what memory a frame takes; the others are made side by
/// side as far as threads and memory go. A frame's file depends on its input and the options alone.
/// Each file's metadata has "frame", "frames", "time" (where the input has it) and "job", by which
/// a later run knows a frame that is finished.
///
/// Adds stages "read" (the first pass) and those of the frames, summed up, to `report`; a warning
/// that several frames give is told once and names the first of them; "hidden-values" is judged
/// over the values of all frames. Throws what run() throws, with the frame named; frames made until
/// then stay, and a run after the cause is mended goes on from there. Error(Invalid) for arrays
/// that change from frame to frame; Error(Usage) for job.meshOutput, which is for one mesh.
SequenceResult runSequence(const VoxelizeJob& job, const std::vector<Frame>& frames,
                           const SequenceOptions& options, Report& report, Progress& progress);

} // namespace tetvdb
