// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/FrameRun.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/ResidentBytes.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <tbb/task_arena.h>
#include <thread>
#include <utility>

namespace tetvdb {

std::string frameTitle(const Frame& frame, std::size_t i) {
  std::string name = fmt::format("frame {} ({}", i + 1, frame.inputs.front());
  if (frame.timeStep >= 0)
    name += fmt::format(", step {}", frame.timeStep + 1);
  return name + ")";
}

namespace {

Error inFrame(const Error& error, const Frame& frame, std::size_t i) {
  if (error.status() == Status::Cancelled)
    return Error(Status::Cancelled, "", "cancelled or out of time",
                 "frames that are finished are kept");
  // An option that is valid for the first frame is valid for the others, unless they differ.
  const bool changed = i > 0 && error.status() == Status::Usage;
  return Error(changed ? Status::Invalid : error.status(), frameTitle(frame, i), error.what());
}

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

// Calls work(i) for i in [begin, end) from `workers` threads, each with its share of the arena's
// threads; the first failure ends all, and its exception is thrown.
template <typename Work>
void inParallel(std::size_t begin, std::size_t end, std::size_t workers, const Work& work) {
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
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

} // namespace

std::size_t forEachFrame(const std::vector<Frame>& frames, std::size_t maxMemory,
                         Progress& progress,
                         const std::function<void(std::size_t i, Progress&)>& work) {
  std::atomic<std::size_t> done{0};
  const auto run = [&](std::size_t i) {
    progress.check();
    try {
      FrameProgress own(progress);
      work(i, own.progress());
    } catch (const Error& error) {
      throw inFrame(error, frames[i], i);
    }
    progress.update(static_cast<double>(++done) / static_cast<double>(frames.size()));
  };
  run(0);
  if (frames.size() == 1)
    return 1;
  // At least what one frame takes.
  const std::size_t each = std::max<std::size_t>(peakResidentBytes(), 1);
  const std::size_t room = maxMemory != 0 ? maxMemory : availableBytes();
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const std::size_t atOnce =
      std::max<std::size_t>(1, std::min({room / each, frames.size() - 1, threads}));
  inParallel(1, frames.size(), atOnce, run);
  return atOnce;
}

void addReports(const std::vector<Report>& reports, const std::vector<Frame>& frames,
                const std::string& leftOut, Report& report) {
  std::vector<Stage> stages;
  std::map<std::string, std::pair<Warning, std::size_t>> warnings;
  std::vector<std::string> order;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    report.partial = report.partial || reports[i].partial;
    for (const Stage& stage : reports[i].stages) {
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
    for (const Warning& warning : reports[i].warnings) {
      if (warning.code == leftOut)
        continue;
      // The second of a code in one frame is about something else.
      const std::string key = warning.code + "/" + std::to_string(ofFrame[warning.code]++);
      auto [at, added] = warnings.try_emplace(key, warning, 0);
      if (added) {
        order.push_back(key);
        at->second.first.text = frameTitle(frames[i], i) + ": " + warning.text;
      }
      ++at->second.second;
    }
  }
  for (Stage& stage : stages)
    report.stages.push_back(std::move(stage));
  for (const std::string& key : order) {
    const auto& [warning, count] = warnings.at(key);
    report.warn(warning.code, count == 1
                                  ? warning.text
                                  : fmt::format("{} (and likewise in {} other frame{})",
                                                warning.text, count - 1, count == 2 ? "" : "s"));
  }
}

} // namespace tetvdb
