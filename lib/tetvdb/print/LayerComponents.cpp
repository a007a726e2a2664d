// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/LayerComponents.h"

#include "tetvdb/core/DisjointSets.h"

#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint8_t kWhite = 128;

// Calls visit(i, j) for spans i of row y and j of row y - 1 that are connected.
template <typename Visit>
void forEachTouch(const SpanRows& rows, std::int32_t y, Neighbours neighbours, const Visit& visit) {
  const std::int32_t reach = neighbours == Neighbours::Eight ? 1 : 0;
  const std::vector<Span>& spans = rows.spans();
  auto [j, endJ] = rows.rangeOf(y - 1);
  const auto [begin, end] = rows.rangeOf(y);
  for (std::size_t i = begin; i < end; ++i) {
    while (j < endJ && spans[j].end + reach <= spans[i].begin)
      ++j;
    for (std::size_t other = j; other < endJ && spans[other].begin < spans[i].end + reach; ++other)
      visit(i, other);
  }
}

void measure(LabelledSpans& region, std::uint32_t first) {
  std::uint32_t count = first;
  for (const std::uint32_t label : region.labels)
    count = std::max(count, label + 1);
  region.shapes.assign(count, {});
  std::vector<std::int32_t> longest(count, 0);
  for (std::int32_t y = region.rows.firstRow(); y < region.rows.endRow(); ++y) {
    const auto [begin, end] = region.rows.rangeOf(y);
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t label = region.labels[i];
      if (label < first)
        continue;
      const Span& span = region.rows.spans()[i];
      ComponentShape& shape = region.shapes[label];
      const std::int32_t length = span.end - span.begin;
      shape.pixels += length;
      shape.box.include({span.begin, y, span.end - 1, y});
      if (length > longest[label]) {
        longest[label] = length;
        shape.x = span.begin + (length - 1) / 2;
        shape.y = y;
      }
    }
  }
}

SpanRows gapsOf(const SpanRows& solid) {
  SpanRows gaps;
  for (std::int32_t y = solid.firstRow(); y < solid.endRow(); ++y) {
    const auto [begin, end] = solid.of(y);
    for (const Span* span = begin; span < end && span + 1 < end; ++span)
      gaps.add(y, span->end, span[1].begin);
  }
  return gaps;
}

// Labels spans between two of the solid; spans that extend around the solid of the next row are
// outside.
LabelledSpans labelledGaps(const SpanRows& solid, Neighbours neighbours) {
  LabelledSpans region;
  region.rows = gapsOf(solid);
  const SpanRows& rows = region.rows;
  const auto count = rows.spans().size();
  const std::int32_t reach = neighbours == Neighbours::Eight ? 1 : 0;
  DisjointSets sets(count);
  std::vector<std::uint8_t> open(count, 0);
  for (std::int32_t y = rows.firstRow(); y < rows.endRow(); ++y) {
    forEachTouch(rows, y, neighbours, [&](std::size_t i, std::size_t j) {
      sets.join(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j));
    });
    const auto [begin, end] = rows.rangeOf(y);
    for (const std::int32_t next : {y - 1, y + 1}) {
      const auto [first, last] = solid.of(next);
      for (std::size_t i = begin; i < end; ++i)
        if (first == last || rows.spans()[i].begin - reach < first->begin ||
            rows.spans()[i].end + reach > last[-1].end)
          open[i] = 1;
    }
  }
  // A component is outside if one of its spans is.
  for (std::uint32_t i = 0; i < count; ++i)
    if (open[i])
      open[sets.find(i)] = 1;
  region.labels.resize(count);
  std::uint32_t next = 1;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t root = sets.find(i);
    region.labels[i] = open[root] ? 0 : root == i ? next++ : region.labels[root];
  }
  measure(region, 1);
  return region;
}

} // namespace

SpanRows solidOf(const Layer& layer) {
  SpanRows rows;
  for (std::size_t i = 0; i < layer.rows.size(); ++i) {
    const auto [begin, end] = layer.runsOf(i);
    for (const PixelRun* run = begin; run != end; ++run)
      if (run->value >= kWhite)
        rows.add(layer.rows[i].y, run->begin, run->end);
  }
  return rows;
}

LabelledSpans labelled(SpanRows rows, Neighbours neighbours) {
  LabelledSpans region;
  region.rows = std::move(rows);
  const std::size_t count = region.rows.spans().size();
  DisjointSets sets(count);
  for (std::int32_t y = region.rows.firstRow(); y < region.rows.endRow(); ++y)
    forEachTouch(region.rows, y, neighbours, [&](std::size_t i, std::size_t j) {
      sets.join(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j));
    });
  region.labels.resize(count);
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t root = sets.find(i);
    region.labels[i] = root == i ? next++ : region.labels[root];
  }
  measure(region, 0);
  return region;
}

LayerComponents componentsOf(SpanRows solid, Neighbours neighbours) {
  LayerComponents layer;
  layer.gaps = labelledGaps(solid, complementOf(neighbours));
  layer.solid = labelled(std::move(solid), neighbours);
  return layer;
}

} // namespace tetvdb
