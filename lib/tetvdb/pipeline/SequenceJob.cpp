// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/SequenceJob.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/fields/Field.h"
#include "tetvdb/fields/NeededArrays.h"
#include "tetvdb/fields/ShownValues.h"
#include "tetvdb/fields/SmoothCells.h"
#include "tetvdb/pipeline/ArrayOutput.h"
#include "tetvdb/pipeline/FrameMark.h"
#include "tetvdb/pipeline/MergeMeshes.h"
#include "tetvdb/pipeline/SequenceGrids.h"
#include "tetvdb/voxelize/ChooseTransform.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <optional>
#include <tbb/task_arena.h>
#include <thread>
#include <utility>

namespace tetvdb {
namespace {

// The results of the first pass for a frame.
struct Look {
  WorldBox box;
  std::vector<std::string> names; ///< of the grids made of arrays
  std::vector<ValueRange> ranges; ///< of the same
};

// Progress of one frame: it stops when the whole job stops.
class FrameProgress {
public:
  explicit FrameProgress(Progress& whole) {
    own_.setDeadline(whole.deadline());
    own_.onReport([this, &whole](std::string_view, double) {
      if (whole.cancelled())
        own_.cancel();
    });
  }
  Progress& progress() { return own_; }

private:
  Progress own_;
};

std::string nameOf(const Frame& frame, std::size_t i) {
  std::string name = fmt::format("frame {} ({}", i + 1, frame.inputs.front());
  if (frame.timeStep >= 0)
    name += fmt::format(", step {}", frame.timeStep + 1);
  return name + ")";
}

Error inFrame(const Error& error, const Frame& frame, std::size_t i) {
  if (error.status() == Status::Cancelled)
    return Error(Status::Cancelled, "", "cancelled or out of time",
                 "frames that are finished are kept");
  // An option that is valid for the first frame is valid for the others, unless they differ.
  const bool changed = i > 0 && error.status() == Status::Usage;
  return Error(changed ? Status::Invalid : error.status(), nameOf(frame, i), error.what());
}

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

// Calls work(i) for i in [begin, end) from `workers` threads, each with its share of the job's
// threads; the first failure ends all, and its exception is thrown.
template <typename Work>
void inParallel(std::size_t begin, std::size_t end, std::size_t workers, const Work& work) {
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  workers = std::max<std::size_t>(1, std::min({workers, end - begin, threads}));
  std::atomic<std::size_t> next{begin};
  std::atomic<bool> failed{false};
  std::mutex mutex;
  std::exception_ptr failure;
  std::size_t failedAt = end;
  const auto loop = [&] {
    tbb::task_arena arena(static_cast<int>((threads + workers - 1) / workers));
    for (std::size_t i = next++; i < end && !failed; i = next++) {
      try {
        arena.execute([&] { work(i); });
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (i < failedAt) {
          failedAt = i;
          failure = std::current_exception();
        }
        failed = true;
      }
    }
  };
  std::vector<std::thread> others;
  for (std::size_t w = 1; w < workers; ++w)
    others.emplace_back(loop);
  loop();
  for (std::thread& other : others)
    other.join();
  if (failure)
    std::rethrow_exception(failure);
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
    std::atomic<std::size_t> done{0};
    const auto look = [&](std::size_t i) {
      try {
        FrameProgress own(progress_);
        looks_[i] = lookAt(job_, frames_[i], told[i], own.progress());
      } catch (const Error& error) {
        throw inFrame(error, frames_[i], i);
      }
      progress_.update(static_cast<double>(++done) / static_cast<double>(frames_.size()));
    };
    look(0);
    if (frames_.size() > 1)
      inParallel(1, frames_.size(), framesAtOnce(), look);

    WorldBox box;
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      box.add(looks_[i].box);
      if (looks_[i].names != looks_.front().names)
        throw Error(Status::Invalid, nameOf(frames_[i], i),
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

  // By the memory of the process so far, which is at least that of one frame.
  std::size_t framesAtOnce() const {
    const std::size_t each = std::max<std::size_t>(peakResidentBytes(), 1);
    const std::size_t room = job_.maxMemory != 0 ? job_.maxMemory : availableBytes();
    return std::max<std::size_t>(1, room / each);
  }

  void secondPass() {
    done_ = 0;
    make(0);
    if (frames_.size() == 1)
      return;
    result_.atOnce = std::min({framesAtOnce(), frames_.size() - 1,
                               static_cast<std::size_t>(tbb::this_task_arena::max_concurrency())});
    inParallel(1, frames_.size(), result_.atOnce, [&](std::size_t i) { make(i); });
  }

  void make(std::size_t i) {
    progress_.check();
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
    } else {
      try {
        FrameProgress own(progress_);
        VoxelizeResult made = tetvdb::run(job, reports_[i], own.progress());
        out.grids = std::move(made.grids);
        out.output = made.outputs.front();
      } catch (const Error& error) {
        throw inFrame(error, frames_[i], i);
      }
    }
    progress_.update(static_cast<double>(++done_) / static_cast<double>(frames_.size()));
  }

  // Sums the stages of all frames by name, and collects warnings once each.
  void sumUp() {
    std::vector<Stage> stages;
    std::map<std::string, std::pair<Warning, std::size_t>> warnings;
    std::vector<std::string> order;
    for (const Report& one : reports_) {
      report_.partial = report_.partial || one.partial;
      for (const Stage& stage : one.stages) {
        const auto known = std::find_if(stages.begin(), stages.end(),
                                        [&](const Stage& s) { return s.name == stage.name; });
        if (known == stages.end()) {
          stages.push_back({stage.name, stage.seconds, stage.peakBytes, {}});
        } else {
          known->seconds += stage.seconds;
          known->peakBytes = std::max(known->peakBytes, stage.peakBytes);
        }
      }
      std::map<std::string, std::size_t> ofFrame;
      for (const Warning& warning : one.warnings) {
        if (warning.code == kHiddenValues)
          continue; // judged over all frames
        // The second of a code in one frame is about something else.
        const std::string key = warning.code + "/" + std::to_string(ofFrame[warning.code]++);
        auto [at, added] = warnings.try_emplace(key, warning, 0);
        if (added) {
          order.push_back(key);
          const auto frame = static_cast<std::size_t>(&one - reports_.data());
          at->second.first.text = nameOf(frames_[frame], frame) + ": " + warning.text;
        }
        ++at->second.second;
      }
    }
    for (Stage& stage : stages)
      report_.stages.push_back(std::move(stage));
    for (const std::string& key : order) {
      const auto& [warning, count] = warnings.at(key);
      report_.warn(warning.code, count == 1
                                     ? warning.text
                                     : fmt::format("{} (and likewise in {} other frame{})",
                                                   warning.text, count - 1, count == 2 ? "" : "s"));
    }
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
                               grid.all.name, why, nameOf(frames_[at], at), grid.all.name));
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
  std::atomic<std::size_t> done_{0};
  SequenceResult result_;
};

} // namespace

SequenceResult runSequence(const VoxelizeJob& job, const std::vector<Frame>& frames,
                           const SequenceOptions& options, Report& report, Progress& progress) {
  return inArena(job.threads,
                 [&] { return SequenceRun(job, frames, options, report, progress).run(); });
}

} // namespace tetvdb
