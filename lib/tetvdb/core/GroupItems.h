// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/JoinedVectors.h"
#include "tetvdb/core/LargeVector.h"
#include "tetvdb/core/Progress.h"

#include <algorithm>
#include <cstddef>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <vector>

namespace tetvdb {

/// Ascending items, in groups of equal keys.
template <typename Item>
struct GroupedItems {
  LargeVector<Item> items;
  std::vector<std::size_t> starts; ///< of each group, and the end

  std::size_t groupCount() const { return starts.size() - 1; }
  const Item& firstOf(std::size_t group) const { return items[starts[group]]; }
};

/// The items that emit(i, out) appends to the vector `out` for i from 0 to count - 1. Their
/// operator< compares key() and then i. Parallel, independent of the number of threads: items of
/// each block of `blockSize` numbers are sorted by one task, and blocks are joined key by key.
/// Where blocks have few keys, this is a fraction of the time to sort all items.
template <typename Item, typename Emit>
GroupedItems<Item> groupItems(std::size_t count, std::size_t blockSize, const Emit& emit,
                              Progress& progress) {
  struct Run { // items of one key in a block
    const Item* first;
    std::size_t block, size;
  };
  const std::size_t blocks = (count + blockSize - 1) / blockSize;
  std::vector<std::vector<Item>> itemsOf(blocks);
  std::vector<std::vector<Run>> runsOf(blocks);
  tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t block) {
    progress.check();
    std::vector<Item>& items = itemsOf[block];
    for (std::size_t i = block * blockSize; i < std::min(count, (block + 1) * blockSize); ++i)
      emit(i, items);
    std::sort(items.begin(), items.end());
    for (std::size_t i = 0, end; i < items.size(); i = end) {
      for (end = i + 1; end < items.size() && items[end].key() == items[i].key();)
        ++end;
      runsOf[block].push_back({&items[i], block, end - i});
    }
  });
  std::vector<Run> runs = joinedVectors<Run>(runsOf);
  tbb::parallel_sort(runs.begin(), runs.end(), [&](const Run& a, const Run& b) {
    const auto keyA = a.first->key(), keyB = b.first->key();
    return keyA != keyB ? keyA < keyB : a.block < b.block;
  });

  GroupedItems<Item> grouped;
  std::vector<std::size_t> places(runs.size());
  std::size_t total = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (i == 0 || runs[i].first->key() != runs[i - 1].first->key())
      grouped.starts.push_back(total);
    places[i] = total;
    total += runs[i].size;
  }
  grouped.starts.push_back(total);
  grouped.items.resize(total);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, runs.size(), 16), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      std::copy_n(runs[i].first, runs[i].size, &grouped.items[places[i]]);
  });
  return grouped;
}

} // namespace tetvdb
