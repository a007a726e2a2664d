// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/BoxBlocks.h"

#include "tetvdb/core/ForEachIndex.h"

#include <algorithm>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
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

// By the upper halves, stable (Knuth, The Art of Computer Programming 3, 5.2.5): digit by digit,
// each task a range of its own.
void radixSort(LargeVector<std::uint64_t>& keys) {
  constexpr unsigned kDigit = kAxisBits;
  constexpr std::size_t kDigits = std::size_t(1) << kDigit, kKeysPerTask = std::size_t(1) << 15;
  const std::size_t tasks = (keys.size() + kKeysPerTask - 1) / kKeysPerTask;
  LargeVector<std::uint64_t> other(keys.size());
  std::vector<std::size_t> places(tasks * kDigits); // of a task's next key with a digit
  for (unsigned shift = 32; shift < 32 + 3 * kAxisBits; shift += kDigit) {
    std::fill(places.begin(), places.end(), 0);
    const auto eachKey = [&](const auto& visit) {
      tbb::parallel_for(std::size_t(0), tasks, [&](std::size_t task) {
        const std::size_t end = std::min(keys.size(), (task + 1) * kKeysPerTask);
        for (std::size_t i = task * kKeysPerTask; i < end; ++i)
          visit(keys[i], places[task * kDigits + (keys[i] >> shift & (kDigits - 1))]);
      });
    };
    eachKey([](std::uint64_t, std::size_t& count) { ++count; });
    std::size_t total = 0;
    for (std::size_t digit = 0; digit < kDigits; ++digit)
      for (std::size_t task = 0; task < tasks; ++task)
        total += std::exchange(places[task * kDigits + digit], total);
    eachKey([&](std::uint64_t key, std::size_t& place) { other[place++] = key; });
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

BoxBlocks::FloatBox BoxBlocks::boundOf(const Block& block) {
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
      unsigned bits = meeting(boxes, boxIn(own, i));
      if (other == block)
        bits &= ~0u << (i + 1);
      for (; bits != 0; bits &= bits - 1)
        found.push_back({order_[kWidth * block + i],
                         order_[kWidth * other + static_cast<std::size_t>(__builtin_ctz(bits))]});
    }
    return found.size() > max;
  });
}

BoxBlocks::BoxBlocks(std::size_t count, const std::function<Box(std::size_t)>& boxOf)
    : order_(count) {
  if (count == 0)
    return;
  LargeVector<FloatBox> boxes(count);
  const Box all = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, kPerTask), Box{},
      [&](const auto& range, Box sum) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const Box box = boxOf(i);
          boxes[i] = outward(box);
          sum.add(box);
        }
        return sum;
      },
      [](Box a, const Box& b) {
        a.add(b);
        return a;
      });
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k)
    longest = std::max(longest, all.high[k] - all.low[k]);
  const double scale = longest > 0 ? ((1u << kAxisBits) - 1) / (2 * longest) : 0;
  LargeVector<std::uint64_t> keys(count);
  forEachIndex(count, [&](std::size_t i) {
    std::uint64_t code = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      // Boxes that are rounded outward reach beyond `all`.
      const double twice = boxes[i].low[k] - all.low[k] + (boxes[i].high[k] - all.low[k]);
      const double place = std::clamp(twice * scale, 0.0, double((1u << kAxisBits) - 1));
      code |= std::uint64_t(spread(static_cast<std::uint32_t>(place))) << k;
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
  levels_.emplace_back((count + kWidth - 1) / kWidth);
  bounds_.resize(levels_[0].size());
  forEachIndex(levels_[0].size(), [&](std::size_t block) {
    for (std::size_t i = 0; i < kWidth; ++i) {
      const std::size_t place = kWidth * block + i;
      if (place < count) {
        order_[place] = static_cast<std::uint32_t>(keys[place]);
        put(levels_[0][block], i, boxes[order_[place]]);
      } else {
        put(levels_[0][block], i, empty);
      }
    }
    bounds_[block] = boundOf(levels_[0][block]);
  });
  while (levels_.back().size() > 1) {
    const LargeVector<Block>& below = levels_.back();
    LargeVector<Block> level((below.size() + kWidth - 1) / kWidth);
    forEachIndex(level.size(), [&](std::size_t block) {
      for (std::size_t i = 0; i < kWidth; ++i) {
        const std::size_t child = kWidth * block + i;
        put(level[block], i, child < below.size() ? boundOf(below[child]) : empty);
      }
    });
    levels_.push_back(std::move(level));
  }
}

} // namespace tetvdb
