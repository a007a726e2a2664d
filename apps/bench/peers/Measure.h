// SPDX-License-Identifier: Apache-2.0
//
// Timing of rivals in turns, so that whatever else the machine does hits all of them alike.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace tetvdb::bench {

/// Seconds of repeated runs, in the order in which they were made.
struct Times {
  std::vector<double> seconds;

  double median() const;
  double min() const;
  double max() const;
};

/// peer.median() / ours.median().
double ratioOfMedians(const Times& ours, const Times& peer);
/// Median of peer / ours over the rounds in which both ran.
double medianOfRatios(const Times& ours, const Times& peer);

/// Something to time; `run` returns the seconds it took, and so can leave out what is not its own.
struct Rival {
  std::string name;
  std::function<double()> run;
  int rounds = 0; ///< at most so many; 0: as many as the others
};

/// Runs the rivals in turns, A B C A B C ..., `rounds` times. Each first runs once untimed if
/// `warmUp`.
std::vector<Times> interleave(const std::vector<Rival>& rivals, int rounds, bool warmUp);

/// Seconds that `f` takes.
template <typename F>
double secondsOf(const F& f) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  f();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Bytes a second that all threads together read and write in a = b + s * c, best of a few runs;
/// what the floors of all rows are computed from.
double measureBandwidth();

} // namespace tetvdb::bench
