// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/LayerContacts.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace tetvdb {
namespace {

// Gathers pairs. The last one of each label above is stored, since components have the same
// contacts in successive rows.
class Contacts {
public:
  explicit Contacts(std::size_t above) : last_(above, kNone) {}

  void add(std::uint32_t below, std::uint32_t above) {
    if (last_[above] == below)
      return;
    last_[above] = below;
    contacts_.push_back({below, above});
  }

  std::vector<LayerContact> take() {
    std::sort(contacts_.begin(), contacts_.end());
    contacts_.erase(std::unique(contacts_.begin(), contacts_.end()), contacts_.end());
    return std::move(contacts_);
  }

private:
  static constexpr std::uint32_t kNone = ~std::uint32_t(0);
  std::vector<std::uint32_t> last_;
  std::vector<LayerContact> contacts_;
};

struct VoidSpan {
  std::int32_t begin, end;
  std::uint32_t label;
};

// All void of a row, from left to right; `spans` is a buffer.
void voidOf(const LayerComponents& layer, std::int32_t y, std::vector<VoidSpan>& spans) {
  constexpr std::int32_t kLow = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t kHigh = std::numeric_limits<std::int32_t>::max();
  spans.clear();
  const auto [first, last] = layer.solid.rows.of(y);
  if (first == last) {
    spans.push_back({kLow, kHigh, 0});
    return;
  }
  spans.push_back({kLow, first->begin, 0});
  const auto [begin, end] = layer.gaps.rows.rangeOf(y);
  for (std::size_t i = begin; i < end; ++i) {
    const Span& span = layer.gaps.rows.spans()[i];
    spans.push_back({span.begin, span.end, layer.gaps.labels[i]});
  }
  spans.push_back({last[-1].end, kHigh, 0});
}

} // namespace

std::vector<LayerContact> solidContacts(const LabelledSpans& below, const LabelledSpans& above) {
  return nearContacts(below, above, 0, 0);
}

std::vector<LayerContact> nearContacts(const LabelledSpans& below, const LabelledSpans& above,
                                       std::int32_t columns, std::int32_t rows) {
  Contacts contacts(above.shapes.size());
  const std::vector<Span>& lower = below.rows.spans();
  const std::vector<Span>& upper = above.rows.spans();
  for (std::int32_t y = above.rows.firstRow(); y < above.rows.endRow(); ++y) {
    const auto [begin, end] = above.rows.rangeOf(y);
    if (begin == end)
      continue;
    for (std::int32_t row = y - rows; row <= y + rows; ++row) {
      auto [j, endJ] = below.rows.rangeOf(row);
      for (std::size_t i = begin; i < end && j < endJ; ++i) {
        while (j < endJ && lower[j].end + columns <= upper[i].begin)
          ++j;
        for (std::size_t other = j; other < endJ && lower[other].begin < upper[i].end + columns;
             ++other)
          contacts.add(below.labels[other], above.labels[i]);
      }
    }
  }
  return contacts.take();
}

std::vector<LayerContact> voidContacts(const LayerComponents& below, const LayerComponents& above) {
  Contacts contacts(std::max<std::size_t>(above.gaps.shapes.size(), 1)); // 0: the outside
  std::vector<VoidSpan> lower, upper;
  const SpanRows &gapsBelow = below.gaps.rows, &gapsAbove = above.gaps.rows;
  const std::int32_t first = gapsBelow.empty() ? gapsAbove.firstRow()
                             : gapsAbove.empty()
                                 ? gapsBelow.firstRow()
                                 : std::min(gapsBelow.firstRow(), gapsAbove.firstRow());
  const std::int32_t end = gapsBelow.empty()   ? gapsAbove.endRow()
                           : gapsAbove.empty() ? gapsBelow.endRow()
                                               : std::max(gapsBelow.endRow(), gapsAbove.endRow());
  for (std::int32_t y = first; y < end; ++y) {
    const auto [b0, b1] = gapsBelow.rangeOf(y);
    const auto [a0, a1] = gapsAbove.rangeOf(y);
    if (b0 == b1 && a0 == a1)
      continue; // outside only
    voidOf(below, y, lower);
    voidOf(above, y, upper);
    std::size_t j = 0;
    for (const VoidSpan& span : upper) {
      while (j < lower.size() && lower[j].end <= span.begin)
        ++j;
      for (std::size_t other = j; other < lower.size() && lower[other].begin < span.end; ++other)
        if (lower[other].label != 0 || span.label != 0)
          contacts.add(lower[other].label, span.label);
    }
  }
  return contacts.take();
}

} // namespace tetvdb
