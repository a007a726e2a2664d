// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/SequenceJob.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/fields/Field.h"
#include "tetvdb/fields/NeededArrays.h"
#include "tetvdb/fields/ShownValues.h"
#include "tetvdb/fields/SmoothCells.h"
#include "tetvdb/pipeline/ArrayOutput.h"
#include "tetvdb/pipeline/FrameMark.h"
#include "tetvdb/pipeline/FrameRun.h"
#include "tetvdb/pipeline/MergeMeshes.h"
#include "tetvdb/pipeline/SequenceGrids.h"
#include "tetvdb/voxelize/ChooseTransform.h"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <utility>

namespace tetvdb {
namespace {

// The results of the first pass for a frame.
struct Look {
  WorldBox box;
  std::vector<std::string> names; ///< of the grids made of arrays
  std::vector<ValueRange> ranges; ///< of the same
};

bool needsTwoPassesOfArrays(const VoxelizeJob& job) {
  return !job.fields.empty();
}

Look lookAt(const VoxelizeJob& job, const Frame& frame, Report& report, Progress& progress) {
  Look look;
  if (holdsTriangles(frame.inputs.front())) {
    for (const std::string& input : frame.inputs) {
      TriangleMesh mesh = readSoup(input, nullptr, report, progress);
      turnUp(mesh.points, job.up);
      look.box.add(boxOf(mesh, job.solid));
    }
    return look;
  }
  ReadOptions read = job.read;
  read.timeStep = frame.timeStep;
  read.attributes = needsTwoPassesOfArrays(job) || !job.warp.array.empty();
  read.arrays = neededArrays(job.fields, job.warp);
  std::vector<TetMesh> meshes;
  for (const std::string& input : frame.inputs) {
    meshes.push_back(readTets(input, read, job.filter, nullptr, report, progress));
    warpPoints(meshes.back(), job.warp);
    if (job.smooth)
      smoothCells(meshes.back());
    turnUp(meshes.back().points, job.up);
    look.box.add(boxOfUsed(meshes.back().points, meshes.back().tets));
  }
  if (!needsTwoPassesOfArrays(job))
    return look;
  const TetMesh mesh = mergeMeshes(std::move(meshes), report);
  for (const Field& field : resolveFields(mesh, job.fields, report)) {
    look.names.push_back(field.name);
    look.ranges.push_back(field.original);
  }
  return look;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names)
    text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

class SequenceRun {
public:
  SequenceRun(const VoxelizeJob& job, const std::vector<Frame>& frames,
              const SequenceOptions& options, Report& report, Progress& progress)
      : job_(job), frames_(frames), options_(options), report_(report), progress_(progress),
        reports_(frames.size()) {}

  SequenceResult run() {
    check();
    result_.frames.resize(frames_.size());
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      result_.frames[i].frame = frames_[i];
      result_.frames[i].output.path = frameName(job_.output, i + 1, frames_.size());
    }
    checkFiles();
    firstPass();
    progress_.stage("frames");
    try {
      secondPass();
    } catch (...) {
      sumUp();
      throw;
    }
    sumUp();
    return std::move(result_);
  }

private:
  void check() const {
    if (frames_.empty())
      throw Error(Status::Usage, "", "the sequence has no frames");
    if (!job_.preview.empty())
      throw Error(Status::Usage, "`preview`", "is for one frame; this is a sequence",
                  "render frames with 'tetvdb render run.0001.vdb -o run.png'");
    if (!job_.meshOutput.empty())
      throw Error(Status::Usage, "`write_mesh`", "is for one mesh, not for a sequence",
                  "leave it out");
    requireFormat(job_.output, {FormatUse::WriteVolume, FormatUse::WriteArrays});
    checkArrayOutput(job_);
  }

  void checkFiles() const {
    std::vector<std::string> inputs = job_.inputs, outputs;
    for (const FrameResult& frame : result_.frames) {
      inputs.insert(inputs.end(), frame.frame.inputs.begin(), frame.frame.inputs.end());
      outputs.push_back(frame.output.path);
    }
    requireSeparateFiles(inputs, outputs);
    requireWritable(outputs.front());
  }

  // Meshes are read and released: as many at a time as memory permits.
  void firstPass() {
    StageTimer timer(report_, "read");
    timer.part("all frames, for their box and arrays");
    progress_.stage("first pass");
    looks_.resize(frames_.size());
    std::vector<Report> told(frames_.size());
    forEachFrame(frames_, job_.maxMemory, progress_, [&](std::size_t i, Progress& own) {
      looks_[i] = lookAt(job_, frames_[i], told[i], own);
    });

    WorldBox box;
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      box.add(looks_[i].box);
      if (looks_[i].names != looks_.front().names)
        throw Error(Status::Invalid, frameTitle(frames_[i], i),
                    "has other arrays than the first frame: " + listed(looks_[i].names) +
                        " in place of " + listed(looks_.front().names),
                    "name arrays that all frames have");
      for (std::size_t k = 0; k < looks_[i].ranges.size(); ++k)
        looks_.front().ranges[k].add(looks_[i].ranges[k]);
    }
    result_.transform = chooseTransform(box, job_.voxelize, job_.solid);
    reportTransform(result_.transform, job_.voxelize, report_);
    if (isArrayFile(job_.output) && !job_.arrays.box)
      arrayBox_ = arrayBox(job_, box, result_.transform);
  }

  void secondPass() {
    result_.atOnce = forEachFrame(frames_, job_.maxMemory, progress_,
                                  [&](std::size_t i, Progress& own) { make(i, own); });
  }

  void make(std::size_t i, Progress& progress) {
    FrameResult& out = result_.frames[i];
    VoxelizeJob job = job_;
    job.inputs = frames_[i].inputs;
    job.read.timeStep = frames_[i].timeStep;
    job.output = out.output.path;
    job.voxelize.voxelSize = result_.transform.voxelSize;
    job.voxelize.origin = result_.transform.origin;
    if (arrayBox_)
      job.arrays.box = arrayBox_;
    job.fieldRanges = looks_.front().ranges;
    job.threads = 0; // those of the current arena
    job.metadata["frame"] = std::to_string(i + 1);
    job.metadata["frames"] = std::to_string(frames_.size());
    if (frames_[i].time)
      job.metadata["time"] = fmt::format("{}", *frames_[i].time);
    const std::string mark = frameMark(job);
    job.metadata["job"] = mark;
    if (!options_.again && isFinished(job.output, mark)) {
      out.skipped = true;
      out.output = written(job.output);
      return;
    }
    VoxelizeResult made = tetvdb::run(job, reports_[i], progress);
    out.grids = std::move(made.grids);
    out.output = made.outputs.front();
  }

  void sumUp() {
    addReports(reports_, frames_, kHiddenValues, report_); // which is judged over all frames
    warnOfHiddenValues();
  }

  // A grid is visible if any of its frames is. The values of frames from an earlier run are
  // unknown.
  void warnOfHiddenValues() {
    std::vector<std::vector<GridInfo>> grids;
    bool allKnown = true;
    for (const FrameResult& frame : result_.frames) {
      grids.push_back(frame.grids);
      allKnown = allKnown && !frame.grids.empty();
    }
    for (const SequenceGrid& grid : gridsOfSequence(grids)) {
      const std::string why = whyHidden(grid.all);
      if (why.empty() || (grid.all.maxValue < kMinShown && !allKnown))
        continue;
      const std::size_t at = grid.all.minValue < 0 ? grid.minFrame : grid.maxFrame;
      report_.warn(kHiddenValues,
                   fmt::format("'{}' {} (in all frames; see {}); `remap={}=0:1` "
                               "makes it visible",
                               grid.all.name, why, frameTitle(frames_[at], at), grid.all.name));
    }
  }

  const VoxelizeJob& job_;
  const std::vector<Frame>& frames_;
  const SequenceOptions& options_;
  Report& report_;
  Progress& progress_;
  std::vector<Look> looks_;
  std::optional<VoxelBox> arrayBox_; ///< of arrays: the same for all frames
  std::vector<Report> reports_;
  SequenceResult result_;
};

} // namespace

SequenceResult runSequence(const VoxelizeJob& job, const std::vector<Frame>& frames,
                           const SequenceOptions& options, Report& report, Progress& progress) {
  return inArena(job.threads,
                 [&] { return SequenceRun(job, frames, options, report, progress).run(); });
}

} // namespace tetvdb
