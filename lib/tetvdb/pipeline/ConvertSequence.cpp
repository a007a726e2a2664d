// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/ConvertSequence.h"

#include "tetvdb/core/InArena.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/pipeline/ConvertInput.h"
#include "tetvdb/pipeline/FrameRun.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <utility>

namespace tetvdb {
namespace {

class SequenceConversion {
public:
  SequenceConversion(const ConvertJob& job, const std::vector<Frame>& frames, Report& report,
                     Progress& progress)
      : job_(job), frames_(frames), report_(report), progress_(progress), reports_(frames.size()) {}

  std::vector<FrameResult> run() {
    check();
    if (isArrayFile(job_.output) && !job_.arrays.box)
      uniteBoxes();
    progress_.stage("frames");
    try {
      forEachFrame(frames_, roomForFrames(), progress_,
                   [&](std::size_t i, Progress& own) { convert(i, own); });
    } catch (...) {
      addReports(reports_, frames_, {}, report_);
      throw;
    }
    addReports(reports_, frames_, {}, report_);
    compareGrids();
    return std::move(results_);
  }

private:
  void check() {
    if (frames_.empty())
      throw Error(Status::Usage, "", "the sequence has no frames");
    if (job_.tileSize > 0)
      throw Error(Status::Usage, "`tiles`", "is for one volume; the inputs are a sequence",
                  "give one frame");
    std::vector<std::string> inputs, outputs;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const std::vector<std::string>& files = frames_[i].inputs;
      if (files.size() > 1)
        throw Error(Status::Usage, frameTitle(frames_[i], i),
                    fmt::format("is in {} files, which are not joined here", files.size()),
                    "'tetvdb voxelize' joins them");
      inputs.push_back(files.front());
      FrameResult& result = results_.emplace_back();
      result.frame = frames_[i];
      result.output.path = frameName(job_.output, i + 1, frames_.size());
      for (std::string& path : arrayFiles(result.output.path))
        outputs.push_back(std::move(path));
    }
    requireSeparateFiles(inputs, outputs);
  }

  // Converting part by part takes all that a limit leaves: frames then go one by one.
  std::size_t roomForFrames() const { return job_.maxMemory == 0 ? 0 : 1; }

  ConvertJob jobOf(std::size_t i) const {
    ConvertJob job = job_;
    job.input = frames_[i].inputs.front();
    job.isVolume = isVolumeFile(job.input);
    job.output = results_[i].output.path;
    job.allowEmpty = true;
    job.timeStep = frames_[i].timeStep;
    job.threads = 0; // those of the current arena
    if (box_)
      job.arrays.box = box_;
    return job;
  }

  // Arrays of all frames have one size: programs stack them. A first pass reads every frame.
  void uniteBoxes() {
    StageTimer timer(report_, "read");
    timer.part("all frames, for their box");
    progress_.stage("first pass");
    std::vector<VoxelBox> boxes(frames_.size());
    std::vector<openvdb::math::Transform::Ptr> transforms(frames_.size());
    forEachFrame(frames_, roomForFrames(), progress_, [&](std::size_t i, Progress& own) {
      const ConvertJob job = jobOf(i);
      if (!job.isVolume)
        return;
      Report unused; // the second pass tells the same
      const Volume volume = readConverted(job, unused, own);
      boxes[i] = arrayBoxOf(volume);
      if (!volume.grids().all.empty())
        transforms[i] = volume.grids().all.front()->transformPtr();
    });
    VoxelBox all;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (transforms[i] && transforms.front() && *transforms[i] != *transforms.front()) {
        report_.warn("sequence-transform",
                     frameTitle(frames_[i], i) +
                         ": has another transform than the first frame: the array "
                         "of each frame has a box of its own");
        return;
      }
      if (all.empty())
        all = boxes[i];
      for (std::size_t k = 0; k < 3 && !boxes[i].empty(); ++k) {
        all.low[k] = std::min(all.low[k], boxes[i].low[k]);
        all.high[k] = std::max(all.high[k], boxes[i].high[k]);
      }
    }
    if (!all.empty())
      box_ = all;
  }

  void convert(std::size_t i, Progress& progress) {
    ConvertResult made = tetvdb::run(jobOf(i), reports_[i], progress);
    results_[i].grids = std::move(made.grids);
    results_[i].output = made.outputs.front();
  }

  // Programs that play a sequence look for the same grids in every file.
  void compareGrids() {
    const std::vector<GridInfo>& first = results_.front().grids;
    const auto differs = [&](const FrameResult& other) {
      return !std::equal(first.begin(), first.end(), other.grids.begin(), other.grids.end(),
                         [](const GridInfo& a, const GridInfo& b) {
                           return a.name == b.name && a.type == b.type;
                         });
    };
    const auto count = std::count_if(results_.begin(), results_.end(), differs);
    if (count == 0)
      return;
    const auto at = std::find_if(results_.begin(), results_.end(), differs);
    report_.warn("sequence-grids",
                 fmt::format("{}: has {}, and the first frame {}; of {} frames {} differ{} from it",
                             frameTitle(at->frame, static_cast<std::size_t>(at - results_.begin())),
                             listOf(at->grids), listOf(first), results_.size(), count,
                             count == 1 ? "s" : ""));
  }

  static std::string listOf(const std::vector<GridInfo>& grids) {
    std::string text;
    for (const GridInfo& grid : grids)
      text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", grid.name, grid.type);
    return text.empty() ? "no grids" : text;
  }

  const ConvertJob& job_;
  const std::vector<Frame>& frames_;
  Report& report_;
  Progress& progress_;
  std::vector<Report> reports_;
  std::vector<FrameResult> results_;
  std::optional<VoxelBox> box_; ///< of arrays: the same for all frames
};

} // namespace

std::vector<FrameResult> convertSequence(const ConvertJob& job, const std::vector<Frame>& frames,
                                         Report& report, Progress& progress) {
  return inArena(job.threads,
                 [&] { return SequenceConversion(job, frames, report, progress).run(); });
}

} // namespace tetvdb
