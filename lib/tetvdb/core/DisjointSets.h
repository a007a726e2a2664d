// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Sets that grow together (union-find); each is known by its smallest element, so that the result
/// does not depend on the order of joining. Thread-safe; find() returns the smallest element only
/// while no other thread joins.
class DisjointSets {
public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    for (std::size_t i = 0; i < count; ++i)
      parent_[i].store(static_cast<std::uint32_t>(i), std::memory_order_relaxed);
  }
  std::uint32_t find(std::uint32_t element) {
    for (;;) {
      const std::uint32_t parent = parent_[element].load(std::memory_order_relaxed);
      if (parent == element)
        return element;
      // What is no root never becomes one again, and ancestors remain ancestors: another thread's
      // later value may be overwritten.
      const std::uint32_t next = parent_[parent].load(std::memory_order_relaxed);
      parent_[element].store(next, std::memory_order_relaxed);
      element = next;
    }
  }
  void join(std::uint32_t a, std::uint32_t b) {
    for (;;) {
      a = find(a);
      b = find(b);
      if (a == b)
        return;
      std::uint32_t root = std::max(a, b); // unless it was joined meanwhile
      if (parent_[root].compare_exchange_strong(root, std::min(a, b), std::memory_order_relaxed))
        return;
    }
  }

private:
  std::vector<std::atomic<std::uint32_t>> parent_;
};

} // namespace tetvdb
