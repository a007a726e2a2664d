// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

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

/// The number of i from 0 to count - 1 for which holds(i), in the same way.
template <typename Holds>
std::size_t countWhere(std::size_t count, const Holds& holds) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, 4096), std::size_t(0),
      [&](const auto& range, std::size_t sum) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
          sum += holds(i) ? 1 : 0;
        return sum;
      },
      std::plus<>());
}

/// The sum of value(i) for i from 0 to count - 1, the same for any number of threads.
template <typename Value>
double sumOver(std::size_t count, const Value& value) {
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, count, 4096), 0.0,
      [&](const auto& range, double sum) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
          sum += value(i);
        return sum;
      },
      std::plus<>());
}

} // namespace tetvdb
