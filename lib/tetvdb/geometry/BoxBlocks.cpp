// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/BoxBlocks.h"

#include <algorithm>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr unsigned kAxisBits = 10;
constexpr std::size_t kPerTask = 4096;

// Inserts two zero bits between the bits of a number below 2^10.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16) & 0x030000FFu;
  x = (x | x << 8) & 0x0300F00Fu;
  x = (x | x << 4) & 0x030C30C3u;
  return (x | x << 2) & 0x09249249u;
}

// By the upper halves, stable (Knuth, The Art of Computer Programming 3, 5.2.5).
void radixSort(std::vector<std::uint64_t>& keys) {
  constexpr unsigned kDigit = kAxisBits;
  std::vector<std::uint64_t> other(keys.size());
  for (unsigned shift = 32; shift < 32 + 3 * kAxisBits; shift += kDigit) {
    std::array<std::size_t, (1u << kDigit) + 1> starts{};
    for (const std::uint64_t key : keys)
      ++starts[(key >> shift & ((1u << kDigit) - 1)) + 1];
    for (std::size_t i = 0; i < 1u << kDigit; ++i)
      starts[i + 1] += starts[i];
    for (const std::uint64_t key : keys)
      other[starts[key >> shift & ((1u << kDigit) - 1)]++] = key;
    keys.swap(other);
  }
}

} // namespace

BoxBlocks::FloatBox BoxBlocks::outward(const Box& box) {
  constexpr float kMax = std::numeric_limits<float>::max();
  FloatBox result;
  for (std::size_t k = 0; k < 3; ++k) {
    result.low[k] = static_cast<float>(box.low[k]);
    if (static_cast<double>(result.low[k]) > box.low[k])
      result.low[k] = std::nextafter(result.low[k], -kMax);
    result.high[k] = static_cast<float>(box.high[k]);
    if (static_cast<double>(result.high[k]) < box.high[k])
      result.high[k] = std::nextafter(result.high[k], kMax);
  }
  return result;
}

BoxBlocks::FloatBox BoxBlocks::boxOf(const Block& block) {
  FloatBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = *std::min_element(block.low[k].begin(), block.low[k].end());
    box.high[k] = *std::max_element(block.high[k].begin(), block.high[k].end());
  }
  return box;
}

TETVDB_MULTIVERSION
void BoxBlocks::pairs(std::size_t block, std::size_t max,
                      std::vector<std::pair<std::uint32_t, std::uint32_t>>& found) const {
  const Block& own = levels_.front()[block];
  descend(bounds_[block], block, [&](std::size_t other) {
    const Block& boxes = levels_.front()[other];
    unsigned near = meeting(own, bounds_[other]);
    for (; near != 0; near &= near - 1) {
      const auto i = static_cast<std::size_t>(__builtin_ctz(near));
      unsigned bits = meeting(boxes, boxOf(own, i));
      if (other == block)
        bits &= ~0u << (i + 1);
      for (; bits != 0; bits &= bits - 1)
        found.push_back({order_[kWidth * block + i],
                         order_[kWidth * other + static_cast<std::size_t>(__builtin_ctz(bits))]});
    }
    return found.size() > max;
  });
}

BoxBlocks::BoxBlocks(const std::vector<Box>& boxes) : order_(boxes.size()) {
  if (boxes.empty())
    return;
  Box all;
  for (const Box& box : boxes)
    all.add(box);
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k)
    longest = std::max(longest, all.high[k] - all.low[k]);
  const double scale = longest > 0 ? ((1u << kAxisBits) - 1) / (2 * longest) : 0;
  std::vector<std::uint64_t> keys(boxes.size());
  const auto parallel = [](std::size_t count, const auto& each) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kPerTask), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i)
        each(i);
    });
  };
  parallel(boxes.size(), [&](std::size_t i) {
    std::uint64_t code = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double twice = boxes[i].low[k] - all.low[k] + (boxes[i].high[k] - all.low[k]);
      code |= std::uint64_t(spread(static_cast<std::uint32_t>(twice * scale))) << k;
    }
    keys[i] = code << 32 | i;
  });
  radixSort(keys);

  constexpr float kFar = std::numeric_limits<float>::infinity();
  const auto put = [](Block& block, std::size_t i, const FloatBox& box) {
    for (std::size_t k = 0; k < 3; ++k) {
      block.low[k][i] = box.low[k];
      block.high[k][i] = box.high[k];
    }
  };
  const FloatBox empty{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  levels_.emplace_back((boxes.size() + kWidth - 1) / kWidth);
  bounds_.resize(levels_[0].size());
  parallel(levels_[0].size(), [&](std::size_t block) {
    for (std::size_t i = 0; i < kWidth; ++i) {
      const std::size_t place = kWidth * block + i;
      if (place < boxes.size()) {
        order_[place] = static_cast<std::uint32_t>(keys[place]);
        put(levels_[0][block], i, outward(boxes[order_[place]]));
      } else {
        put(levels_[0][block], i, empty);
      }
    }
    bounds_[block] = boxOf(levels_[0][block]);
  });
  while (levels_.back().size() > 1) {
    const std::vector<Block>& below = levels_.back();
    std::vector<Block> level((below.size() + kWidth - 1) / kWidth);
    parallel(level.size(), [&](std::size_t block) {
      for (std::size_t i = 0; i < kWidth; ++i) {
        const std::size_t child = kWidth * block + i;
        put(level[block], i, child < below.size() ? boxOf(below[child]) : empty);
      }
    });
    levels_.push_back(std::move(level));
  }
}

} // namespace tetvdb
