// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/task_arena.h>

namespace tetvdb {

/// Returns work(), run with so many threads; 0: with those of the calling thread's arena.
template <typename Work>
auto inArena(int threads, const Work& work) {
  if (threads <= 0)
    return work();
  tbb::task_arena arena(threads);
  return arena.execute(work);
}

} // namespace tetvdb
