// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"

namespace tetvdb {

/// Maps work done in one grid to the whole job's fraction.
class ProgressShare {
public:
  ProgressShare(Progress& progress, double from, double to)
      : progress_(progress), from_(from), to_(to) {}
  void update(double fraction) const { progress_.update(from_ + (to_ - from_) * fraction); }
  ProgressShare part(double from, double to) const {
    return {progress_, from_ + (to_ - from_) * from, from_ + (to_ - from_) * to};
  }

private:
  Progress& progress_;
  double from_, to_;
};

/// A job's progress for work within one of its steps: it stops that too, and reports nothing.
class QuietProgress : public Progress {
public:
  explicit QuietProgress(Progress& whole) {
    onCheck([&whole] { whole.check(); });
  }
};

} // namespace tetvdb
