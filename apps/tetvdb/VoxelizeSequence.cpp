// SPDX-License-Identifier: Apache-2.0
#include "VoxelizeSequence.h"

#include "JobReport.h"
#include "ProgressDisplay.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/PlannedStages.h"
#include "tetvdb/pipeline/PrepareMesh.h"
#include "tetvdb/pipeline/SequenceJob.h"

#include <algorithm>

namespace tetvdb::cli {
namespace {

// The grid "material" numbers files of triangles, which then belong to one volume.
bool numbersMaterials(const VoxelizeJob& job) {
  return job.inputs.size() > 1 && isNumbered(job.inputs) &&
         contains(job.grids, GridKind::Material) && holdsTriangles(job.inputs.front());
}

} // namespace

void addSequenceOptions(CLI::App& command, SequenceTexts& texts) {
  addFrameOptions(command, texts);
  command.add_flag(
      "--union", texts.unite,
      "Lay numbered files, or a pattern's, together into one volume: they are no frames");
  command.add_flag("--again", texts.again, "Make frames that an earlier run has finished again");
}

bool runAsSequence(VoxelizeJob& job, const SequenceTexts& texts, Session& session) {
  if (texts.unite && !texts.frames.empty())
    throw Error(Status::Usage, "--union", "makes one volume, but --frames asks for a sequence",
                "leave one of them out");
  if (std::any_of(job.inputs.begin(), job.inputs.end(), isPreparedMesh))
    return false;
  if (texts.unite || numbersMaterials(job)) {
    job.inputs = filesOf(job.inputs);
    return false;
  }
  const std::vector<Frame> frames = framesOf(job.inputs, texts, session.report, session.progress);
  if (frames.empty())
    return false;
  if (!job.shard.isWhole() || job.plan > 0)
    throw Error(Status::Usage, "--shard", "is for one volume; the inputs are a sequence",
                "give one frame, or --union");
  if (job.tileSize > 0)
    throw Error(Status::Usage, "--tiles", "is for one volume; the inputs are a sequence",
                "give one frame, or --union");
  if (job.output.empty())
    throw Error(Status::Usage, "", "no output was given", "name one with -o OUT.vdb");
  SequenceOptions options;
  options.again = texts.again;
  session.estimate.plan(plannedSequence(), secondsNow());
  const SequenceResult result = runSequence(job, frames, options, session.report, session.progress);
  addSections(result, session.sections);
  session.text = framesText(result.frames);
  if (job.inputs.size() > 1)
    session.text +=
        "  numbered files are the frames of a sequence; --union makes one volume of them\n";
  session.textIsSummary = true;
  return true;
}

} // namespace tetvdb::cli
