// SPDX-License-Identifier: Apache-2.0
//
// The share of a job of several stages that is done, and the time left.
//
//   tetvdb::TimeEstimate estimate;
//   estimate.plan({{"read", 1}, {"voxelize", 5}, {"write", 2}}, 0);
//   estimate.update("voxelize", 0.4, 12.5);   // seconds on any clock
//   if (const auto seconds = estimate.left()) ...
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// A stage of a job, and its usual share of the time.
struct PlannedStage {
  std::string name;
  double share = 1;  ///< above zero, in any unit
  bool last = false; ///< is all that is left where it comes, whatever is planned behind it
};

/// Not thread-safe. Without a plan every stage is a job of its own.
class TimeEstimate {
public:
  /// The stages to come, in order, from time `now` on; a name can come several times, and stages
  /// that do not occur are skipped.
  void plan(std::vector<PlannedStage> stages, double now);
  /// The job is in `stage`, of which `fraction` is done, at time `now`, in seconds. A stage that is
  /// not among those to come belongs to the one that was planned last.
  void update(std::string_view stage, double fraction, double now);

  /// Share of the job that is done, 0 to 1. With a plan it never falls.
  double done() const { return done_; }
  /// Seconds left: the rest of the stage from the stage's own speed, the later stages from the
  /// job's. Empty while that is too uncertain: in the first two seconds, in the first 3 % of the
  /// job and, without a plan, of the stage, and in stages that were not planned.
  std::optional<double> left() const { return left_; }

private:
  void enter(std::string_view stage, double now);
  void estimate(double fraction, double now);

  std::vector<PlannedStage> stages_;
  std::size_t next_ = 0; ///< the first that has not begun
  bool entered_ = false;
  bool planned_ = false; ///< whether the current stage is one of stages_
  bool byPlan_ = false;
  double before_ = 0, all_ = 0; ///< shares of the stages before, and of all
  double share_ = 0;            ///< of the stage that the job is in
  double began_ = 0, stageBegan_ = 0;
  std::string stage_;
  double done_ = 0;
  std::optional<double> left_;
};

} // namespace tetvdb
