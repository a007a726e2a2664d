// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/HuffmanLengths.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

namespace tetvdb {

std::vector<std::uint8_t> huffmanLengths(const std::vector<std::uint64_t>& counts, int limit) {
  std::vector<std::uint8_t> lengths(counts.size(), 0);
  std::vector<std::pair<std::uint64_t, std::size_t>> leaves; // count, symbol
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0)
      leaves.emplace_back(counts[i], i);
  if (leaves.size() < 2) {
    for (const auto& [count, symbol] : leaves)
      lengths[symbol] = 1;
    return lengths;
  }
  std::sort(leaves.begin(), leaves.end());

  // One list per level: the leaves, merged with pairs of the items of the previous list.
  std::vector<std::vector<bool>> isLeaf;
  std::vector<std::uint64_t> before;
  for (int level = 0; level < limit; ++level) {
    std::vector<std::uint64_t> list;
    std::vector<bool> leaf;
    std::size_t nextLeaf = 0, nextPair = 0;
    while (nextLeaf < leaves.size() || nextPair + 1 < before.size()) {
      const bool hasPair = nextPair + 1 < before.size();
      const std::uint64_t pair = hasPair ? before[nextPair] + before[nextPair + 1] : 0;
      const bool takesLeaf =
          nextLeaf < leaves.size() && (!hasPair || leaves[nextLeaf].first <= pair);
      list.push_back(takesLeaf ? leaves[nextLeaf++].first : pair);
      leaf.push_back(takesLeaf);
      if (!takesLeaf)
        nextPair += 2;
    }
    isLeaf.push_back(std::move(leaf));
    before = std::move(list);
  }
  // A symbol's length is the number of selected items, over all levels, that are its leaf.
  std::size_t taken = 2 * leaves.size() - 2;
  for (std::size_t level = isLeaf.size(); level-- > 0;) {
    const auto begin = isLeaf[level].begin();
    const auto found = static_cast<std::size_t>(
        std::count(begin, begin + static_cast<std::ptrdiff_t>(taken), true));
    for (std::size_t i = 0; i < found; ++i)
      ++lengths[leaves[i].second];
    taken = 2 * (taken - found);
  }
  return lengths;
}

std::vector<std::uint16_t> huffmanWords(const std::vector<std::uint8_t>& lengths) {
  std::array<unsigned, 17> ofLength{}, next{};
  for (const std::uint8_t length : lengths)
    ++ofLength[length];
  ofLength[0] = 0;
  for (std::size_t bits = 1; bits < next.size(); ++bits)
    next[bits] = (next[bits - 1] + ofLength[bits - 1]) << 1;
  std::vector<std::uint16_t> words(lengths.size(), 0);
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    unsigned word = lengths[i] > 0 ? next[lengths[i]]++ : 0, turned = 0;
    for (int bit = 0; bit < lengths[i]; ++bit, word >>= 1)
      turned = turned << 1 | (word & 1);
    words[i] = static_cast<std::uint16_t>(turned);
  }
  return words;
}

} // namespace tetvdb
