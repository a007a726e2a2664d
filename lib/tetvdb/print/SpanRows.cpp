// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/SpanRows.h"

#include <algorithm>

namespace tetvdb {

SpanRows intersectionOf(const SpanRows& a, const SpanRows& b) {
  SpanRows rows;
  if (a.empty() || b.empty())
    return rows;
  const std::int32_t end = std::min(a.endRow(), b.endRow());
  for (std::int32_t y = std::max(a.firstRow(), b.firstRow()); y < end; ++y) {
    auto [i, endI] = a.of(y);
    auto [j, endJ] = b.of(y);
    while (i != endI && j != endJ) {
      rows.add(y, std::max(i->begin, j->begin), std::min(i->end, j->end));
      if (i->end < j->end)
        ++i;
      else
        ++j;
    }
  }
  return rows;
}

SpanRows unionOf(const SpanRows& a, const SpanRows& b) {
  if (a.empty() || b.empty())
    return a.empty() ? b : a;
  SpanRows rows;
  const std::int32_t end = std::max(a.endRow(), b.endRow());
  for (std::int32_t y = std::min(a.firstRow(), b.firstRow()); y < end; ++y) {
    auto [i, endI] = a.of(y);
    auto [j, endJ] = b.of(y);
    Span span{0, 0};
    while (i != endI || j != endJ) {
      const Span next = j == endJ || (i != endI && i->begin < j->begin) ? *i++ : *j++;
      if (next.begin > span.end || span.begin == span.end) {
        rows.add(y, span.begin, span.end);
        span = next;
      } else {
        span.end = std::max(span.end, next.end);
      }
    }
    rows.add(y, span.begin, span.end);
  }
  return rows;
}

} // namespace tetvdb
