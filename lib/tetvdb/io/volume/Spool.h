// SPDX-License-Identifier: Apache-2.0
//
// Bytes that are written to a file later, in order: kept in memory up to a limit, and beyond it in
// an unnamed temporary file.
#pragma once

#include "tetvdb/io/volume/TailStore.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

/// For one thread.
class Spool {
public:
  Spool(const std::string& folder, std::size_t inMemory) : store_(folder, inMemory) {}

  /// Throws Error(Write).
  void add(const std::string& bytes) {
    for (std::size_t at = 0; at < bytes.size(); at += TailStore::kChunk) {
      const std::size_t size = std::min(TailStore::kChunk, bytes.size() - at);
      places_.emplace_back(store_.add(bytes.data() + at, size), static_cast<std::uint32_t>(size));
    }
  }
  /// Calls take(bytes) for all of them in order, once: their room is given back on the way. Throws
  /// Error(Write).
  template <class Take>
  void drain(const Take& take) {
    std::string bytes;
    std::uint64_t released = 0;
    for (const auto& [at, size] : places_) {
      bytes.resize(size);
      store_.read(at, bytes.data(), size);
      take(bytes);
      if (at - released > kReleased) {
        released = at;
        store_.release(released);
      }
    }
  }

private:
  static constexpr std::uint64_t kReleased = std::uint64_t(16) << 20; ///< bytes at a time

  TailStore store_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> places_;
};

} // namespace tetvdb
