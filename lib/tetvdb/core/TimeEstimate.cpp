// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/TimeEstimate.h"

#include <algorithm>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kMinSeconds = 2, kMinDone = 0.03;

} // namespace

void TimeEstimate::plan(std::vector<PlannedStage> stages, double now) {
  *this = TimeEstimate();
  stages_ = std::move(stages);
  byPlan_ = !stages_.empty();
  began_ = now;
  for (const PlannedStage& stage : stages_)
    all_ += stage.last ? 0 : stage.share;
}

void TimeEstimate::update(std::string_view stage, double fraction, double now) {
  if (!entered_ || stage != stage_)
    enter(stage, now);
  estimate(std::clamp(fraction, 0.0, 1.0), now);
}

void TimeEstimate::enter(std::string_view stage, double now) {
  stage_ = stage;
  entered_ = true;
  if (!byPlan_) {
    began_ = now;
    return;
  }
  const auto next =
      std::find_if(stages_.begin() + static_cast<std::ptrdiff_t>(next_), stages_.end(),
                   [&](const PlannedStage& planned) { return planned.name == stage; });
  planned_ = next != stages_.end();
  if (!planned_)
    return;
  const auto at = static_cast<std::size_t>(next - stages_.begin());
  next_ = at + 1;
  stageBegan_ = now;
  if (next->last) {
    before_ = done_ * all_;
    share_ = all_ - before_;
    return;
  }
  before_ = 0;
  for (std::size_t i = 0; i < at; ++i)
    before_ += stages_[i].last ? 0 : stages_[i].share;
  share_ = next->share;
}

void TimeEstimate::estimate(double fraction, double now) {
  left_.reset();
  const double taken = now - began_;
  if (!byPlan_) {
    done_ = fraction;
    if (taken >= kMinSeconds && done_ >= kMinDone)
      left_ = taken * (1 - done_) / done_;
    return;
  }
  if (!planned_)
    return;
  done_ = std::max(done_, (before_ + share_ * fraction) / all_);
  if (taken < kMinSeconds || done_ < kMinDone)
    return;
  const double ofShare = taken / (done_ * all_); // seconds
  const double inStage = now - stageBegan_;
  const bool knowsStage = fraction >= kMinDone && inStage >= kMinSeconds / 2;
  const double stageLeft =
      knowsStage ? inStage * (1 - fraction) / fraction : share_ * (1 - fraction) * ofShare;
  left_ = stageLeft + (all_ - before_ - share_) * ofShare;
}

} // namespace tetvdb
