// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace tetvdb {

/// Sets `max` to the larger of it and `value`, where several threads do.
template <typename Number>
void raiseTo(std::atomic<Number>& max, Number value) {
  Number known = max.load(std::memory_order_relaxed);
  while (known < value && !max.compare_exchange_weak(known, value, std::memory_order_relaxed)) {
  }
}

/// Sets `min` to the smaller of it and `value`, where several threads do.
template <typename Number>
void lowerTo(std::atomic<Number>& min, Number value) {
  Number known = min.load(std::memory_order_relaxed);
  while (value < known && !min.compare_exchange_weak(known, value, std::memory_order_relaxed)) {
  }
}

} // namespace tetvdb
