// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/ErrorDiffusion.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::int32_t kParts = 16; // unit of errors: parts of a level

bool isGrey(std::uint8_t value) {
  return value > 0 && value < 255;
}

// A row of pixels with a black one at each end, and the errors added to them.
struct Row {
  explicit Row(std::int32_t width)
      : values(static_cast<std::size_t>(width) + 2, 0), errors(values.size(), 0) {}

  // Pixel x is at x + 1.
  void take(const Layer& layer, std::size_t row) {
    runs = layer.runsOf(row);
    for (const PixelRun* run = runs.first; run != runs.second; ++run)
      std::fill(values.begin() + run->begin + 1, values.begin() + run->end + 1, run->value);
  }
  void clear() {
    for (const PixelRun* run = runs.first; run != runs.second; ++run) {
      std::fill(values.begin() + run->begin + 1, values.begin() + run->end + 1, std::uint8_t(0));
      std::fill(errors.begin() + run->begin + 1, errors.begin() + run->end + 1, 0);
    }
    runs = {nullptr, nullptr};
  }

  std::vector<std::uint8_t> values;
  std::vector<std::int32_t> errors; ///< in parts
  std::pair<const PixelRun*, const PixelRun*> runs{nullptr, nullptr};
};

} // namespace

void diffuseErrors(Layer& layer, std::int32_t width, int levels) {
  Layer result;
  result.filled = layer.filled;
  result.overlap = layer.overlap;
  Row current(width), next(width);
  std::int32_t carry = 0; // to the next grey pixel, in parts
  const std::int32_t top = levels - 1;
  const auto visit = [&](std::size_t at, std::ptrdiff_t ahead) {
    const std::int32_t wanted = current.values[at] * kParts + current.errors[at] + carry;
    const std::int32_t level =
        std::clamp((wanted * top + 255 * kParts / 2) / (255 * kParts), 0, top);
    const std::int32_t value = (2 * 255 * level + top) / (2 * top);
    current.values[at] = static_cast<std::uint8_t>(value);
    const std::int32_t error = wanted - value * kParts;
    std::int32_t left = error;
    const auto give = [&](Row& row, std::ptrdiff_t step, std::int32_t weight) {
      const auto to = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + step);
      if (!isGrey(row.values[to]))
        return;
      const std::int32_t part = error * weight / 16;
      row.errors[to] += part;
      left -= part;
    };
    give(current, ahead, 7);
    give(next, -ahead, 3);
    give(next, 0, 5);
    give(next, ahead, 1);
    carry = left;
  };
  for (std::size_t i = 0; i < layer.rows.size(); ++i) {
    const std::int32_t y = layer.rows[i].y;
    if (i == 0 || layer.rows[i - 1].y + 1 != y) { // `next` was not this row
      current.clear();
      current.take(layer, i);
    }
    if (i + 1 < layer.rows.size() && layer.rows[i + 1].y == y + 1)
      next.take(layer, i + 1);
    const auto [begin, end] = layer.runsOf(i);
    if (y % 2 == 0) {
      for (const PixelRun* run = begin; run != end; ++run)
        for (std::int32_t x = run->begin; isGrey(run->value) && x < run->end; ++x)
          visit(static_cast<std::size_t>(x) + 1, 1);
    } else {
      for (const PixelRun* run = end; run-- != begin;)
        for (std::int32_t x = run->end; isGrey(run->value) && x > run->begin; --x)
          visit(static_cast<std::size_t>(x), -1);
    }
    for (const PixelRun* run = begin; run != end; ++run) {
      if (!isGrey(run->value)) {
        result.add(y, run->begin, run->end, run->value);
        continue;
      }
      for (std::int32_t x = run->begin; x < run->end; ++x)
        result.add(y, x, x + 1, current.values[static_cast<std::size_t>(x) + 1]);
    }
    current.clear();
    std::swap(current, next);
  }
  result.contours = std::move(layer.contours);
  layer = std::move(result);
}

} // namespace tetvdb
