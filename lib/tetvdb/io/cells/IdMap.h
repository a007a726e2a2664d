// SPDX-License-Identifier: Apache-2.0
//
// Maps arbitrary numbers of nodes and elements in a file to indices from 0.
//
//   tetvdb::IdMap ids;
//   for (...) ids.add(number);              // element 0, element 1, ...
//   ids.finish();
//   const std::uint32_t index = ids.find(7);   // IdMap::kNone: no such element
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tetvdb {

/// Index of an element by its number. Consecutive numbers, the usual case, need no memory; numbers
/// with gaps a table, and scattered ones a sorted list.
class IdMap {
public:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  /// Numbers the next element. At most kNone elements.
  void add(std::int64_t id) {
    if (listed_.empty()) {
      if (count_ == 0)
        first_ = id;
      if (id == number(count_)) {
        ++count_;
        return;
      }
      list();
    }
    listed_.push_back(id);
    ++count_;
  }
  /// To be called between the last add() and the first find().
  void finish();

  std::size_t size() const { return count_; }
  bool consecutive() const { return consecutive_; }
  std::int64_t first() const { return first_; }
  /// Elements whose number a later one repeats; find() returns the later one.
  std::size_t duplicates() const { return duplicates_; }

  std::uint32_t find(std::int64_t id) const {
    const auto offset = static_cast<std::uint64_t>(id) - static_cast<std::uint64_t>(first_);
    if (consecutive_)
      return offset < count_ ? static_cast<std::uint32_t>(offset) : kNone;
    if (!table_.empty())
      return offset < table_.size() ? table_[offset] : kNone;
    return search(id);
  }

private:
  // Unsigned, since invalid numbers would overflow.
  std::int64_t number(std::size_t offset) const {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(first_) + offset);
  }
  void list();
  std::uint32_t search(std::int64_t id) const;

  std::size_t count_ = 0;
  std::int64_t first_ = 0;
  bool consecutive_ = true;
  std::size_t duplicates_ = 0;
  std::vector<std::int64_t> listed_; ///< all numbers in order, once they are not consecutive
  std::vector<std::uint32_t> table_; ///< by number - first_
  std::vector<std::pair<std::int64_t, std::uint32_t>> sorted_;
};

} // namespace tetvdb
