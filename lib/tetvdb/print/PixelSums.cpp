// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/PixelSums.h"

#include "tetvdb/geometry/Exact.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>

namespace tetvdb {
namespace {

constexpr std::int64_t kWhole = GreyLevels::kWhole;
constexpr std::int64_t kSnap = kWhole >> 32; // as in coverage grids, fields/Coverage.h

std::int64_t snapped(std::int64_t share) {
  const std::int64_t nearest = (share + kWhole / 2) & -kWhole;
  return std::abs(share - nearest) <= kSnap ? nearest : share;
}

std::int64_t whole(double part) {
  return std::llrint(part * static_cast<double>(kWhole));
}

// A row from left to right.
class RowBuilder {
public:
  RowBuilder(std::int32_t y, const GreyLevels& levels, Layer& layer)
      : y_(y), levels_(levels), layer_(layer) {}

  void add(std::int32_t begin, std::int32_t end, std::int64_t share) {
    const std::int64_t clamped = std::clamp<std::int64_t>(share, 0, kWhole);
    filled += Int128(clamped) * (end - begin);
    overlap += Int128(std::max<std::int64_t>(share - kWhole, 0)) * (end - begin);
    layer_.add(y_, begin, end, levels_.of(clamped));
  }

  Int128 filled = 0, overlap = 0;

private:
  std::int32_t y_;
  const GreyLevels& levels_;
  Layer& layer_;
};

} // namespace

void PixelSums::add(std::int32_t x, std::int32_t y, double cover, double share) {
  const std::int64_t wholeCover = whole(cover), wholeShare = whole(share);
  if (!events_.empty()) {
    Event& last = events_.back();
    if (last.x == x && last.y == y) {
      last.cover += wholeCover;
      last.share += wholeShare;
      return;
    }
  }
  if (wholeCover != 0 || wholeShare != 0)
    events_.push_back({x, y, wholeCover, wholeShare});
}

// A counting sort, and within rows by x.
void PixelSums::sortByRow() {
  std::int32_t low = std::numeric_limits<std::int32_t>::max(), high = -1;
  for (const Event& e : events_) {
    low = std::min(low, e.y);
    high = std::max(high, e.y);
  }
  starts_.assign(static_cast<std::size_t>(high - low) + 2, 0);
  for (const Event& e : events_)
    ++starts_[static_cast<std::size_t>(e.y - low) + 1];
  for (std::size_t i = 1; i < starts_.size(); ++i)
    starts_[i] += starts_[i - 1];
  sorted_.resize(events_.size());
  for (const Event& e : events_)
    sorted_[starts_[static_cast<std::size_t>(e.y - low)]++] = e;
  for (std::size_t begin = 0; begin < sorted_.size();) {
    const std::size_t end = starts_[static_cast<std::size_t>(sorted_[begin].y - low)];
    std::sort(sorted_.begin() + static_cast<std::ptrdiff_t>(begin),
              sorted_.begin() + static_cast<std::ptrdiff_t>(end),
              [](const Event& a, const Event& b) { return a.x < b.x; });
    begin = end;
  }
}

void PixelSums::finish(const GreyLevels& levels, Layer& layer) {
  layer.clear();
  if (events_.empty())
    return;
  sortByRow();
  Int128 filled = 0, overlap = 0;
  for (std::size_t i = 0; i < sorted_.size();) {
    const std::int32_t y = sorted_[i].y;
    RowBuilder row(y, levels, layer);
    std::int64_t carry = 0;
    std::int32_t at = sorted_[i].x;
    while (i < sorted_.size() && sorted_[i].y == y) {
      const std::int32_t x = sorted_[i].x;
      if (carry != 0)
        row.add(at, x, carry);
      std::int64_t cover = 0, share = 0;
      for (; i < sorted_.size() && sorted_[i].y == y && sorted_[i].x == x; ++i) {
        cover += sorted_[i].cover;
        share += sorted_[i].share;
      }
      row.add(x, x + 1, snapped(carry + share));
      carry = snapped(carry + cover);
      at = x + 1;
    }
    if (std::abs(carry) > kWhole >> 20)
      throw std::logic_error("the boundary of a layer does not close");
    filled += row.filled;
    overlap += row.overlap;
  }
  layer.filled = static_cast<double>(filled) / static_cast<double>(kWhole);
  layer.overlap = static_cast<double>(overlap) / static_cast<double>(kWhole);
}

} // namespace tetvdb
