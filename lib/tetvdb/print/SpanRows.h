// SPDX-License-Identifier: Apache-2.0
//
// A set of pixels as rows of spans.
//
//   tetvdb::SpanRows rows;
//   rows.add(3, 10, 20);   // pixels 10 to 19 of row 3
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tetvdb {

/// Pixels begin to end - 1 of a row.
struct Span {
  std::int32_t begin = 0, end = 0;
};

/// Rows ascend; the spans of a row ascend and do not touch. Memory: 8 bytes per span and per row
/// between the first and the last.
class SpanRows {
public:
  void clear() {
    starts_.clear();
    spans_.clear();
  }

  /// Appends after all existing spans; a span that touches the last of its row is merged with it.
  void add(std::int32_t y, std::int32_t begin, std::int32_t end) {
    if (begin >= end)
      return;
    if (starts_.empty())
      first_ = y;
    while (endRow() <= y)
      starts_.push_back(spans_.size());
    if (spans_.size() > starts_.back() && spans_.back().end >= begin)
      spans_.back().end = end;
    else
      spans_.push_back({begin, end});
  }

  bool empty() const { return spans_.empty(); }
  std::int32_t firstRow() const { return first_; }
  /// One past the last row.
  std::int32_t endRow() const { return first_ + static_cast<std::int32_t>(starts_.size()); }
  /// Of all rows, in order.
  const std::vector<Span>& spans() const { return spans_; }

  /// The range of the spans of row y in spans(); empty for rows without any.
  std::pair<std::size_t, std::size_t> rangeOf(std::int32_t y) const {
    if (starts_.empty() || y < first_ || y >= endRow())
      return {0, 0};
    const auto i = static_cast<std::size_t>(y - first_);
    return {starts_[i], i + 1 < starts_.size() ? starts_[i + 1] : spans_.size()};
  }
  /// The spans of row y.
  std::pair<const Span*, const Span*> of(std::int32_t y) const {
    const auto [begin, end] = rangeOf(y);
    return {spans_.data() + begin, spans_.data() + end};
  }

private:
  std::int32_t first_ = 0;
  std::vector<std::size_t> starts_;
  std::vector<Span> spans_;
};

/// The intersection and the union of two sets. About 5 ns per span.
SpanRows intersectionOf(const SpanRows& a, const SpanRows& b);
SpanRows unionOf(const SpanRows& a, const SpanRows& b);

} // namespace tetvdb
