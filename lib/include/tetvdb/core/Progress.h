// SPDX-License-Identifier: Apache-2.0
//
// Cancellation, deadline and progress of a long job. Every public function that can take over a
// second takes a `Progress&`.
//
//   tetvdb::Progress progress;
//   progress.onReport([](std::string_view stage, double fraction) { draw(stage, fraction); });
//   auto mesh = tetvdb::readMesh("a.vtu", progress);   // throws Error(Cancelled) after cancel()
#pragma once

#include "tetvdb/core/Error.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace tetvdb {

/// Shared between the thread that waits and the threads that work: every method is thread-safe,
/// apart from onReport(), onCheck() and setDeadline(), which are called while no work is under way.
class Progress {
public:
  using Clock = std::chrono::steady_clock;
  using Callback = std::function<void(std::string_view stage, double fraction)>;

  /// Calls `callback` at most about ten times a second, from any thread, one call at a time.
  void onReport(Callback callback) { callback_ = std::move(callback); }
  /// Calls `poll` whenever check() is called, from any thread, several at a time: a few ns is what
  /// it should take nearly always. It may call cancel(). Empty: nothing is called.
  void onCheck(std::function<void()> poll) { poll_ = std::move(poll); }
  /// From `deadline` on, check() throws.
  void setDeadline(Clock::time_point deadline) { deadline_ = deadline; }
  Clock::time_point deadline() const { return deadline_; } ///< max() where there is none

  /// Asks the job to stop; async-signal-safe.
  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

  /// Throws Error(Cancelled) once cancelled or past the deadline. Cheap enough for every task of a
  /// millisecond or more.
  void check() const {
    if (poll_)
      poll_();
    if (cancelled())
      throw Error(Status::Cancelled, "", "cancelled", "nothing was written");
    if (deadline_ != Clock::time_point::max() && Clock::now() > deadline_)
      throw Error(Status::Cancelled, "", "the time limit was reached",
                  "nothing was written; raise `max_time` or lower the resolution");
  }

  /// Names what is being done from now on; fraction returns to 0.
  void stage(std::string_view name) {
    {
      std::lock_guard<std::mutex> lock(mutex_);
      stage_ = name;
    }
    report(0.0, true);
  }

  /// Says that `fraction` (0 to 1) of the stage is done, and throws as check() does.
  void update(double fraction) {
    check();
    report(fraction, false);
  }

private:
  void report(double fraction, bool always) {
    if (!callback_)
      return;
    const auto now = Clock::now().time_since_epoch().count();
    auto last = lastReport_.load(std::memory_order_relaxed);
    constexpr auto interval =
        std::chrono::duration_cast<Clock::duration>(std::chrono::milliseconds(100)).count();
    if (!always && now - last < interval)
      return;
    if (!lastReport_.compare_exchange_strong(last, now) && !always)
      return;
    std::lock_guard<std::mutex> lock(mutex_);
    callback_(stage_, fraction);
  }

  Callback callback_;
  std::function<void()> poll_;
  Clock::time_point deadline_ = Clock::time_point::max();
  std::atomic<bool> cancelled_{false};
  std::atomic<Clock::rep> lastReport_{0};
  std::mutex mutex_;
  std::string stage_;
};

} // namespace tetvdb
