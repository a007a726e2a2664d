// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/FrameRun.h"

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

Error inFrame(const Error& error, const Frame& frame, std::size_t i) {
  if (error.status() == Status::Cancelled)
    return Error(Status::Cancelled, "", "cancelled or out of time",
                 "frames that are finished are kept");
  // An option that is valid for the first frame is valid for the others, unless they differ.
  const bool changed = i > 0 && error.status() == Status::Usage;
  return Error(changed ? Status::Invalid : error.status(), frameTitle(frame, i), error.what());
}

FrameProgress::FrameProgress(Progress& whole) {
  own_.setDeadline(whole.deadline());
  own_.onReport([this, &whole](std::string_view, double) {
    if (whole.cancelled())
      own_.cancel();
  });
}

std::size_t framesAtOnce(std::size_t maxMemory) {
  const std::size_t each = std::max<std::size_t>(peakResidentBytes(), 1);
  return std::max<std::size_t>(1, (maxMemory != 0 ? maxMemory : availableBytes()) / each);
}

void forFrames(std::size_t begin, std::size_t end, std::size_t workers,
               const std::function<void(std::size_t)>& work) {
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
