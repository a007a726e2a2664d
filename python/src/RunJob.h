// SPDX-License-Identifier: Apache-2.0
//
// Work of the library on behalf of a Python call: without the GIL, stopped by Ctrl-C and other
// signals whose Python handlers raise, with errors as tetvdb.Error and warnings as Python's.
//
//   JobRun run(limits);
//   auto result = run([&](Report& report, Progress& progress) { return tetvdb::run(job, ...); });
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <nanobind/nanobind.h>
#include <optional>
#include <thread>

namespace tetvdb::python {

namespace nb = nanobind;

/// Limits that every job has.
struct JobLimits {
  int threads = 0; ///< 0: one a core; in a process that was forked from one with the module: 1
  std::size_t maxMemory = 0; ///< bytes; 0: what the machine has available
  double maxTime = 0;        ///< seconds; 0: none
};

/// Makes the types tetvdb.Error and tetvdb.MeshWarning, and the translation of errors.
void addErrors(nb::module_& module);

/// Remembers forks from now on. Called once.
void watchForks();

/// Threads that a job may use where nothing else is asked for; 0: one a core.
int defaultThreads();

/// Polls Python's signal handlers from Progress::check() on the calling thread, which are run at
/// most every 20 ms. Lives while the GIL is held, and is polled while it is released.
class SignalPoll {
public:
  explicit SignalPoll(Progress& progress);
  ~SignalPoll();
  SignalPoll(const SignalPoll&) = delete;
  SignalPoll& operator=(const SignalPoll&) = delete;

  /// Throws what a handler raised, if one did. With the GIL.
  void rethrow();

private:
  using Clock = std::chrono::steady_clock;
  void poll();

  Progress& progress_;
  std::thread::id caller_ = std::this_thread::get_id();
  Clock::time_point next_;
  std::optional<nb::python_error> raised_;
};

/// The exit status that the command line has for a job that was done.
inline Status statusOf(const Report& report) {
  return report.partial ? Status::Partial : Status::Ok;
}

/// Gives every warning of `report` from number `first` on to Python's warnings.
void issueWarnings(const Report& report, std::size_t first = 0);

class JobRun {
public:
  /// `warns`: what the report has of warnings becomes Python's.
  explicit JobRun(const JobLimits& limits, bool warns = true) : warns_(warns) {
    if (limits.maxTime > 0) // a year is as good as for ever, and fits the clock
      progress_.setDeadline(Progress::Clock::now() +
                            std::chrono::duration_cast<Progress::Clock::duration>(
                                std::chrono::duration<double>(std::min(limits.maxTime, 3.2e7))));
  }

  /// Runs `work(report, progress)`. Throws what it throws, and what a signal's handler raised.
  template <typename Work>
  auto operator()(const Work& work) {
    SignalPoll signals(progress_);
    try {
      auto result = [&] {
        const nb::gil_scoped_release released;
        return work(report_, progress_);
      }();
      if (warns_)
        issueWarnings(report_);
      return result;
    } catch (const Error&) {
      signals.rethrow();
      throw;
    }
  }

  Report& report() { return report_; }

private:
  bool warns_;
  Report report_;
  Progress progress_;
};

} // namespace tetvdb::python
