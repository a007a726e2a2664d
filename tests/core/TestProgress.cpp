// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Progress.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

TEST(Progress, onCheckIsCalledByEveryCheckAndMayCancel) {
  Progress progress;
  int calls = 0;
  progress.onCheck([&] {
    if (++calls == 3)
      progress.cancel();
  });
  progress.check();
  progress.update(0.5);
  try {
    progress.check();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Cancelled);
  }
  EXPECT_EQ(calls, 3);
  progress.onCheck({});
  EXPECT_THROW(progress.check(), Error);
  EXPECT_EQ(calls, 3);
}

} // namespace
} // namespace tetvdb
