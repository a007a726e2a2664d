// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {

/// Calls visit(i) for i from 0 to count - 1, on all threads, 4096 or fewer at a time: for visits of
/// a few nanoseconds each.
template <typename Visit>
void forEachIndex(std::size_t count, const Visit& visit) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      visit(i);
  });
}

} // namespace tetvdb
