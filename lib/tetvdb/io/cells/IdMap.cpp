// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/cells/IdMap.h"

#include <algorithm>

namespace tetvdb {

void IdMap::list() {
  listed_.resize(count_);
  for (std::size_t i = 0; i < count_; ++i)
    listed_[i] = number(i);
}

void IdMap::finish() {
  if (listed_.empty())
    return;
  consecutive_ = false;
  const auto [low, high] = std::minmax_element(listed_.begin(), listed_.end());
  first_ = *low;
  const auto span = static_cast<std::uint64_t>(*high) - static_cast<std::uint64_t>(*low);
  if (span < 4 * static_cast<std::uint64_t>(count_) + 1024) {
    table_.assign(static_cast<std::size_t>(span) + 1, kNone);
    for (std::size_t i = 0; i < count_; ++i) {
      std::uint32_t& slot = table_[static_cast<std::size_t>(listed_[i] - first_)];
      if (slot != kNone)
        ++duplicates_;
      slot = static_cast<std::uint32_t>(i);
    }
  } else {
    sorted_.reserve(count_);
    for (std::size_t i = 0; i < count_; ++i)
      sorted_.emplace_back(listed_[i], static_cast<std::uint32_t>(i));
    std::sort(sorted_.begin(), sorted_.end());
    for (std::size_t i = 1; i < count_; ++i)
      if (sorted_[i].first == sorted_[i - 1].first)
        ++duplicates_;
  }
  listed_ = {};
}

std::uint32_t IdMap::search(std::int64_t id) const {
  const auto after =
      std::upper_bound(sorted_.begin(), sorted_.end(), std::pair{id, kNone},
                       [](const auto& a, const auto& b) { return a.first < b.first; });
  return after != sorted_.begin() && (after - 1)->first == id ? (after - 1)->second : kNone;
}

} // namespace tetvdb
