// SPDX-License-Identifier: Apache-2.0
//
// Runs the kernels' source on the host, one item after another; tests compare its results with the
// device's.
#pragma once

#include "Team.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <numeric>
#include <vector>

namespace tetvdb::nano {

class HostBackend {
public:
  /// Memory is filled with a pattern that no kernel writes, so that reads of unwritten memory
  /// become visible.
  template <typename T>
  T* alloc(u64 n) {
    return take<T>(n, blocks_);
  }
  /// Memory that is valid until dropTemporaries().
  template <typename T>
  T* temp(u64 n) {
    return take<T>(n, temporaries_);
  }
  void dropTemporaries() { temporaries_.clear(); }
  void require(u64) {}
  void release() {
    blocks_.clear();
    temporaries_.clear();
  }
  void stage(const char*) {}
  // Parts in which a mesh's cells arrive.
  int parts() const { return 3; }
  void awaitPoints() {}
  void awaitCells(int) {}
  u8* output(u64 bytes) { return alloc<u8>(bytes); }

  void zero(void* p, u64 bytes) { std::memset(p, 0, bytes); }
  void fill(void* p, int byte, u64 bytes) { std::memset(p, byte, bytes); }
  template <typename T>
  T read(const T* p) {
    return *p;
  }
  template <typename T>
  void download(T* to, const T* from, u64 n) {
    std::copy_n(from, n, to);
  }

  void await() {}
  void upload(void* to, const void* from, u64 bytes) {
    if (bytes != 0)
      std::memcpy(to, from, bytes);
  }
  /// Sends bytes to the host by one of two queues; landed() waits for the last copy of that queue.
  void land(int way, const u8* from, u64 bytes) { landed_[way].assign(from, from + bytes); }
  const u8* landed(int way) const { return landed_[way].data(); }

  template <typename F>
  void forEach(u64 n, const F& f) {
    for (u64 i = 0; i < n; ++i)
      f(i);
  }
  template <typename Shared, typename F>
  void forTeams(u64 n, int, const F& f) {
    const auto shared = std::make_unique<Shared>();
    for (u64 i = 0; i < n; ++i)
      f(Team(0, 1), i, *shared);
  }
  /// offsets[i] = counts[0] + ... + counts[i - 1], i up to n.
  void scan(const u32* counts, u64* offsets, u64 n) {
    u64 sum = 0;
    for (u64 i = 0; i < n; ++i) {
      offsets[i] = sum;
      sum += counts[i];
    }
    offsets[n] = sum;
  }
  /// By the lowest `bits` bits of the keys; equal keys keep their order.
  void sort(u64* keys, u32* values, u64 n, int) {
    std::vector<u32> order(n);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](u32 a, u32 b) { return keys[a] < keys[b]; });
    const std::vector<u64> oldKeys(keys, keys + n);
    const std::vector<u32> oldValues(values, values + n);
    for (u64 i = 0; i < n; ++i) {
      keys[i] = oldKeys[order[i]];
      values[i] = oldValues[order[i]];
    }
  }

private:
  struct Free {
    void operator()(unsigned char* p) const { ::operator delete(p, std::align_val_t(64)); }
  };
  using Blocks = std::vector<std::unique_ptr<unsigned char, Free>>;

  template <typename T>
  static T* take(u64 n, Blocks& blocks) {
    const u64 bytes = (n * sizeof(T) + 63) / 64 * 64 + 64;
    blocks.emplace_back(static_cast<unsigned char*>(::operator new(bytes, std::align_val_t(64))));
    std::memset(blocks.back().get(), 0xA5, bytes);
    return reinterpret_cast<T*>(blocks.back().get());
  }

  Blocks blocks_, temporaries_;
  std::vector<u8> landed_[2];
};

} // namespace tetvdb::nano
