// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/TimeEstimate.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

// Goes through a stage of so many seconds that begins at `begin`.
void runStage(TimeEstimate& estimate, const char* name, double begin, double seconds,
              double until = 1) {
  for (int i = 0; i <= 100 && i <= 100 * until; ++i)
    estimate.update(name, i / 100.0, begin + seconds * i / 100.0);
}

TEST(TimeEstimate, AJobThatGoesAsPlanned) {
  TimeEstimate estimate;
  estimate.plan({{"read", 1}, {"voxelize", 6}, {"write", 3}}, 1000);
  runStage(estimate, "read", 1000, 10);
  EXPECT_NEAR(estimate.done(), 0.1, 1e-9);
  EXPECT_NEAR(estimate.left().value(), 90, 1e-6);
  runStage(estimate, "voxelize", 1010, 60, 0.5);
  EXPECT_NEAR(estimate.done(), 0.4, 1e-9);
  EXPECT_NEAR(estimate.left().value(), 60, 1e-6);
  runStage(estimate, "voxelize", 1010, 60);
  runStage(estimate, "write", 1070, 30);
  EXPECT_NEAR(estimate.done(), 1, 1e-9);
  EXPECT_NEAR(estimate.left().value(), 0, 1e-6);
}

TEST(TimeEstimate, AStageThatTakesLongerThanPlanned) {
  TimeEstimate estimate;
  estimate.plan({{"read", 5}, {"voxelize", 5}}, 0);
  runStage(estimate, "read", 0, 10);
  // 100 s in place of 10: the last stage's own rate alone says what is left.
  runStage(estimate, "voxelize", 10, 100, 0.25);
  EXPECT_NEAR(estimate.left().value(), 75, 1e-6);
}

TEST(TimeEstimate, StagesThatDoNotComeAreDone) {
  TimeEstimate estimate;
  estimate.plan({{"read", 1}, {"fields", 8}, {"write", 1}}, 0);
  runStage(estimate, "read", 0, 5);
  estimate.update("write", 0, 5);
  EXPECT_NEAR(estimate.done(), 0.9, 1e-9);
}

TEST(TimeEstimate, AStageInPlaceOfTheRest) {
  const std::vector<PlannedStage> stages = {
      {"read", 2}, {"voxelize", 5}, {"stream", 1, true}, {"fields", 2}, {"write", 1}};
  TimeEstimate estimate;
  estimate.plan(stages, 0);
  runStage(estimate, "read", 0, 4);
  estimate.update("voxelize", 0.2, 6);
  EXPECT_NEAR(estimate.done(), 0.3, 1e-9);
  estimate.update("stream", 0, 6);
  EXPECT_NEAR(estimate.done(), 0.3, 1e-9);
  runStage(estimate, "stream", 6, 70, 0.5);
  EXPECT_NEAR(estimate.done(), 0.65, 1e-9);
  EXPECT_NEAR(estimate.left().value(), 35, 1e-6);
  runStage(estimate, "stream", 6, 70);
  EXPECT_NEAR(estimate.done(), 1, 1e-9);
  // Where it does not come the others are all there is.
  estimate.plan(stages, 0);
  runStage(estimate, "read", 0, 4);
  runStage(estimate, "voxelize", 4, 10);
  EXPECT_NEAR(estimate.done(), 0.7, 1e-9);
  runStage(estimate, "fields", 14, 4);
  runStage(estimate, "write", 18, 2);
  EXPECT_NEAR(estimate.done(), 1, 1e-9);
}

TEST(TimeEstimate, AStageThatWasNotPlannedSaysNothing) {
  TimeEstimate estimate;
  estimate.plan({{"insert", 1}, {"check", 1}}, 0);
  runStage(estimate, "insert", 0, 10);
  EXPECT_TRUE(estimate.left());
  estimate.update("mend", 0.5, 12);
  EXPECT_FALSE(estimate.left());
  EXPECT_NEAR(estimate.done(), 0.5, 1e-9);
  estimate.update("insert", 0.2, 14); // once more
  EXPECT_FALSE(estimate.left());
  EXPECT_NEAR(estimate.done(), 0.5, 1e-9);
  estimate.update("check", 0.5, 20);
  EXPECT_NEAR(estimate.done(), 0.75, 1e-9);
  EXPECT_TRUE(estimate.left());
}

TEST(TimeEstimate, NeverFalls) {
  TimeEstimate estimate;
  estimate.plan({{"a", 1}, {"b", 1}, {"a", 1}}, 0);
  double last = 0;
  double now = 0;
  for (const char* stage : {"a", "b", "b", "x", "a", "b"})
    for (const double fraction : {0.0, 0.5, 0.2, 1.0}) {
      estimate.update(stage, fraction, now += 1);
      EXPECT_GE(estimate.done(), last) << stage;
      EXPECT_LE(estimate.done(), 1);
      last = estimate.done();
    }
}

TEST(TimeEstimate, ANameThatComesTwice) {
  TimeEstimate estimate;
  estimate.plan({{"preview", 1}, {"voxelize", 2}, {"preview", 1}}, 0);
  runStage(estimate, "preview", 0, 1);
  runStage(estimate, "voxelize", 1, 2);
  estimate.update("preview", 0, 3);
  EXPECT_NEAR(estimate.done(), 0.75, 1e-9);
  estimate.update("preview", 0.5, 4);
  EXPECT_NEAR(estimate.done(), 0.875, 1e-9);
}

TEST(TimeEstimate, SaysNothingAtFirst) {
  TimeEstimate estimate;
  estimate.plan({{"read", 1}}, 0);
  estimate.update("read", 0.5, 1);
  EXPECT_FALSE(estimate.left()); // too early
  estimate.update("read", 0.01, 10);
  TimeEstimate other;
  other.plan({{"read", 1}}, 0);
  other.update("read", 0.01, 10);
  EXPECT_FALSE(other.left()); // too little
}

TEST(TimeEstimate, WithoutAPlanEveryStageIsAJob) {
  TimeEstimate estimate;
  runStage(estimate, "read", 0, 10);
  EXPECT_NEAR(estimate.done(), 1, 1e-9);
  runStage(estimate, "compare", 10, 40, 0.25);
  EXPECT_NEAR(estimate.done(), 0.25, 1e-9);
  EXPECT_NEAR(estimate.left().value(), 30, 1e-6);
}

} // namespace
} // namespace tetvdb
