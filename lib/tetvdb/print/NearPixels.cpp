// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/NearPixels.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tetvdb {
namespace {

// Removes from `spans` those of [near, end), each grown by `reach` on both sides.
void subtract(std::vector<Span>& spans, const Span* near, const Span* end, std::int32_t reach,
              std::vector<Span>& room) {
  room.clear();
  for (const Span& span : spans) {
    while (near < end && near->end + reach <= span.begin)
      ++near;
    std::int32_t at = span.begin;
    for (const Span* other = near; other < end && other->begin - reach < span.end; ++other) {
      if (other->begin - reach > at)
        room.push_back({at, other->begin - reach});
      at = std::max(at, other->end + reach);
    }
    if (at < span.end)
      room.push_back({at, span.end});
  }
  spans.swap(room);
}

// Marks rows that equal the previous row.
std::vector<std::uint8_t> repeatedRows(const SpanRows& set) {
  std::vector<std::uint8_t> repeats(static_cast<std::size_t>(set.endRow() - set.firstRow()), 0);
  for (std::int32_t y = set.firstRow() + 1; y < set.endRow(); ++y) {
    const auto [begin, end] = set.of(y);
    const auto [before, beforeEnd] = set.of(y - 1);
    repeats[static_cast<std::size_t>(y - set.firstRow())] =
        std::equal(begin, end, before, beforeEnd, [](const Span& a, const Span& b) {
          return a.begin == b.begin && a.end == b.end;
        });
  }
  return repeats;
}

std::int32_t rowsOf(double limit, const LayerFrame& frame) {
  return static_cast<std::int32_t>(std::ceil(limit / frame.pixelHeight)) + 1;
}

SpanRows thin(const SpanRows& set, const SpanRows& other, double limit, const LayerFrame& frame) {
  const PixelDisc ball(frame.pixelWidth, frame.pixelHeight, limit / 2, true);
  const PixelDisc around(frame.pixelWidth, frame.pixelHeight, limit, false);
  return withoutNear(set, withoutNear(set, other, ball), around);
}

} // namespace

PixelDisc::PixelDisc(double pixelWidth, double pixelHeight, double radius, bool open) {
  const double squared = radius * radius;
  const auto within = [&](double columns, double rows) {
    const double x = columns * pixelWidth, y = rows * pixelHeight;
    const double distance = x * x + y * y;
    return open ? distance < squared : distance <= squared;
  };
  for (std::int32_t dy = 0; within(0, dy); ++dy) {
    const double y = dy * pixelHeight;
    auto dx = static_cast<std::int32_t>(std::sqrt(squared - y * y) / pixelWidth);
    while (within(dx + 1, dy))
      ++dx;
    while (dx > 0 && !within(dx, dy))
      --dx;
    reach_.push_back(dx);
  }
}

SpanRows withoutNear(const SpanRows& from, const SpanRows& other, const PixelDisc& disc) {
  SpanRows left;
  std::vector<Span> spans, room;
  const std::vector<std::uint8_t> repeats = repeatedRows(other);
  const auto isRepeated = [&](std::int32_t row) {
    return row > other.firstRow() && row < other.endRow() &&
           repeats[static_cast<std::size_t>(row - other.firstRow())] != 0;
  };
  const auto leaveOut = [&](std::int32_t row, std::int32_t reach) {
    const auto [near, last] = other.of(row);
    if (near != last)
      subtract(spans, near, last, reach, room);
  };
  const std::int32_t rows = disc.rows();
  for (std::int32_t y = from.firstRow(); y < from.endRow(); ++y) {
    const auto [begin, end] = from.of(y);
    spans.assign(begin, end);
    // The nearest rows first, since their spans grow by more: a row that equals the previous one,
    // closer to y, has no effect.
    if (rows >= 0 && !spans.empty())
      leaveOut(y, disc.reach(0));
    for (std::int32_t dy = 1; dy <= rows && !spans.empty(); ++dy) {
      if (!isRepeated(y - dy + 1))
        leaveOut(y - dy, disc.reach(dy));
      if (!isRepeated(y + dy))
        leaveOut(y + dy, disc.reach(dy));
    }
    for (const Span& span : spans)
      left.add(y, span.begin, span.end);
  }
  return left;
}

SpanRows complementOf(const SpanRows& set, std::int32_t margin) {
  SpanRows rest;
  for (std::int32_t y = set.firstRow() - margin; y < set.endRow() + margin; ++y) {
    std::int32_t at = -kFar;
    const auto [begin, end] = set.of(y);
    for (const Span* span = begin; span != end; ++span) {
      rest.add(y, at, span->begin);
      at = span->end;
    }
    rest.add(y, at, kFar);
  }
  return rest;
}

SpanRows thinPixels(const SpanRows& set, double limit, const LayerFrame& frame) {
  if (set.empty())
    return {};
  return thin(set, complementOf(set, rowsOf(limit, frame)), limit, frame);
}

SpanRows thinGaps(const SpanRows& set, double limit, const LayerFrame& frame) {
  if (set.empty())
    return {};
  return thin(complementOf(set, rowsOf(limit, frame)), set, limit, frame);
}

std::vector<double> widthsOf(const LabelledSpans& part, const SpanRows& other, double maxWidth,
                             const LayerFrame& frame) {
  const auto rows = static_cast<std::int32_t>(std::ceil(maxWidth / frame.pixelHeight));
  std::vector<double> widest(part.shapes.size(), 0);
  for (std::int32_t y = part.rows.firstRow(); y < part.rows.endRow(); ++y) {
    const auto [begin, end] = part.rows.rangeOf(y);
    for (std::size_t i = begin; i < end; ++i) {
      const Span& span = part.rows.spans()[i];
      const std::int32_t x = span.begin + (span.end - 1 - span.begin) / 2;
      double nearest = maxWidth * maxWidth;
      for (std::int32_t row = y - rows; row <= y + rows; ++row) {
        const double dy = (row - y) * frame.pixelHeight;
        const auto [first, last] = other.of(row);
        const Span* after = std::upper_bound(
            first, last, x, [](std::int32_t at, const Span& s) { return at < s.end; });
        double dx = maxWidth;
        if (after != last)
          dx = std::max(after->begin - x, 0) * frame.pixelWidth;
        if (after != first)
          dx = std::min(dx, (x - after[-1].end + 1) * frame.pixelWidth);
        nearest = std::min(nearest, dx * dx + dy * dy);
      }
      double& width = widest[part.labels[i]];
      width = std::max(width, nearest);
    }
  }
  for (double& width : widest)
    width = std::max(2 * std::sqrt(width) - std::min(frame.pixelWidth, frame.pixelHeight), 0.0);
  return widest;
}

} // namespace tetvdb
