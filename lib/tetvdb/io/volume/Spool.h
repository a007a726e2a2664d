// SPDX-License-Identifier: Apache-2.0
//
// Bytes that are written to a file later, in order: kept in memory up to a limit, and beyond it in
// an unnamed temporary file.
#pragma once

#include "tetvdb/io/volume/TailStore.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

/// For one thread.
class Spool {
public:
  Spool(const std::string& folder, std::size_t inMemory)
      : store_(std::make_shared<TailStore>(folder, inMemory)), isOwn_(true) {}
  /// Among what others keep there, which is read when all has been added.
  explicit Spool(std::shared_ptr<TailStore> store) : store_(std::move(store)), isOwn_(false) {}

  /// Throws Error(Write).
  void add(const std::string& bytes) {
    for (std::size_t at = 0; at < bytes.size(); at += TailStore::kChunk)
      places_.push_back(store(bytes, at));
  }
  /// Puts `bytes` before those of the `place`th call of add(), or in place of them; neither more
  /// than TailStore::kChunk.
  void put(std::size_t place, const std::string& bytes, bool replaces) {
    if (replaces)
      places_[place] = store(bytes, 0);
    else
      places_.insert(places_.begin() + static_cast<std::ptrdiff_t>(place), store(bytes, 0));
  }
  /// Calls take(bytes) for all of them in order, once: the room of a store of its own is given back
  /// on the way. Throws Error(Write).
  template <class Take>
  void drain(const Take& take) {
    std::string bytes;
    std::uint64_t released = 0;
    for (const auto& [at, size] : places_) {
      bytes.resize(size);
      store_->read(at, bytes.data(), size);
      take(bytes);
      if (isOwn_ && at - released > kReleased) {
        released = at;
        store_->release(released);
      }
    }
  }

private:
  static constexpr std::uint64_t kReleased = std::uint64_t(16) << 20; ///< bytes at a time
  using Place = std::pair<std::uint64_t, std::uint32_t>;

  Place store(const std::string& bytes, std::size_t at) {
    const std::size_t size = std::min(TailStore::kChunk, bytes.size() - at);
    return {store_->add(bytes.data() + at, size), static_cast<std::uint32_t>(size)};
  }

  std::shared_ptr<TailStore> store_;
  bool isOwn_;
  std::vector<Place> places_;
};

} // namespace tetvdb
