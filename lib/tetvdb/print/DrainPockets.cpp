// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/DrainPockets.h"

#include "tetvdb/print/LayerContacts.h"
#include "tetvdb/print/NearPixels.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kCellsAcross = 8; // the diameter

std::int32_t inCell(double cell, double pixel) {
  return static_cast<std::int32_t>(std::clamp(std::floor(cell / pixel), 1.0, 1e6));
}

// Spans that may overlap, of one row, become a union.
void unite(std::vector<Span>& spans) {
  std::sort(spans.begin(), spans.end(),
            [](const Span& a, const Span& b) { return a.begin < b.begin; });
  std::size_t count = 0;
  for (const Span& span : spans)
    if (count > 0 && span.begin <= spans[count - 1].end)
      spans[count - 1].end = std::max(spans[count - 1].end, span.end);
    else
      spans[count++] = span;
  spans.resize(count);
}

SpanRows unionOf(const SpanRows& a, const SpanRows& b) {
  if (a.empty() || b.empty())
    return a.empty() ? b : a;
  SpanRows rows;
  std::vector<Span> spans;
  const std::int32_t end = std::max(a.endRow(), b.endRow());
  for (std::int32_t y = std::min(a.firstRow(), b.firstRow()); y < end; ++y) {
    const auto [a0, a1] = a.of(y);
    const auto [b0, b1] = b.of(y);
    spans.assign(a0, a1);
    spans.insert(spans.end(), b0, b1);
    unite(spans);
    for (const Span& span : spans)
      rows.add(y, span.begin, span.end);
  }
  return rows;
}

} // namespace

DrainPockets::DrainPockets(const LayerFrame& frame, double diameter)
    : columns_(inCell(diameter / kCellsAcross, frame.pixelWidth)),
      rows_(inCell(diameter / kCellsAcross, frame.pixelHeight)),
      layers_(inCell(diameter / kCellsAcross, frame.layerHeight)),
      width_(columns_ * frame.pixelWidth), height_(rows_ * frame.pixelHeight),
      thickness_(layers_ * frame.layerHeight), radius_(diameter / 2) {}

SpanRows DrainPockets::cellsOf(const SpanRows& solid) const {
  SpanRows cells;
  std::vector<Span> spans;
  if (solid.empty())
    return cells;
  for (std::int32_t row = solid.firstRow() / rows_; row <= (solid.endRow() - 1) / rows_; ++row) {
    spans.clear();
    for (std::int32_t y = row * rows_; y < (row + 1) * rows_; ++y) {
      const auto [begin, end] = solid.of(y);
      for (const Span* span = begin; span != end; ++span) {
        const Span cell{span->begin / columns_, (span->end - 1) / columns_ + 1};
        if (!spans.empty() && cell.begin >= spans.back().begin && cell.end <= spans.back().end)
          continue;
        spans.push_back(cell);
      }
    }
    unite(spans);
    for (const Span& span : spans)
      cells.add(row, span.begin, span.end);
  }
  return cells;
}

void DrainPockets::add(std::int32_t k, const SpanRows& cells) {
  const auto at = static_cast<std::size_t>(cellOf(k));
  if (cells_.size() <= at)
    cells_.resize(at + 1);
  cells_[at] = unionOf(cells_[at], cells);
}

std::vector<Cavity> DrainPockets::find(Progress& progress) const {
  // Discs of the ball's layers, by their distance from its middle.
  std::vector<PixelDisc> discs;
  for (double z = 0; z < radius_; z += thickness_)
    discs.emplace_back(width_, height_, std::sqrt(radius_ * radius_ - z * z), true);
  const auto reach = static_cast<std::int32_t>(discs.size()) - 1;
  const std::int32_t margin = discs.front().rows();
  const auto count = static_cast<std::int32_t>(cells_.size());

  // What a ball's centre cannot be in, in layer k of cells.
  const auto grown = [&](std::int32_t k) {
    SpanRows rows;
    std::vector<Span> spans;
    std::int32_t first = kFar, end = -kFar;
    for (std::int32_t i = std::max(k - reach, 0); i <= std::min(k + reach, count - 1); ++i) {
      const SpanRows& cells = cells_[static_cast<std::size_t>(i)];
      if (cells.empty())
        continue;
      first = std::min(first, cells.firstRow() - margin);
      end = std::max(end, cells.endRow() + margin);
    }
    for (std::int32_t y = first; y < end; ++y) {
      spans.clear();
      for (std::int32_t i = std::max(k - reach, 0); i <= std::min(k + reach, count - 1); ++i) {
        const PixelDisc& disc = discs[static_cast<std::size_t>(std::abs(i - k))];
        for (std::int32_t dy = -disc.rows(); dy <= disc.rows(); ++dy) {
          const auto [begin, last] = cells_[static_cast<std::size_t>(i)].of(y + dy);
          const std::int32_t dx = disc.reach(dy);
          for (const Span* span = begin; span != last; ++span)
            spans.push_back({span->begin - dx, span->end + dx});
        }
      }
      unite(spans);
      for (const Span& span : spans)
        rows.add(y, span.begin, span.end);
    }
    return rows;
  };

  LayerFrame frame;
  frame.pixelWidth = width_;
  frame.pixelHeight = height_;
  frame.layerHeight = frame.firstLayerHeight = thickness_;
  // From below the print, where all is outside.
  CavitySweep sweep(frame);
  LayerComponents below = componentsOf({}, Neighbours::Eight);
  sweep.add(below.gaps, {});
  constexpr std::int32_t kAtOnce = 64;
  std::vector<LayerComponents> layers;
  for (std::int32_t first = -reach; first < count + reach; first += kAtOnce) {
    progress.check();
    const std::int32_t end = std::min(first + kAtOnce, count + reach);
    layers.resize(static_cast<std::size_t>(end - first));
    tbb::parallel_for(first, end, [&](std::int32_t k) {
      layers[static_cast<std::size_t>(k - first)] = componentsOf(grown(k), Neighbours::Eight);
    });
    for (LayerComponents& layer : layers) {
      sweep.add(layer.gaps, voidContacts(below, layer));
      below = std::move(layer);
    }
  }
  sweep.finish();
  std::vector<Cavity> pockets;
  for (Cavity pocket : sweep.cavities()) {
    if (pocket.end != Cavity::End::Closed)
      continue;
    const std::int32_t shift = -reach - 1; // of the sweep's first layer
    pocket.first += shift;
    pocket.last += shift;
    pocket.largestLayer += shift;
    pockets.push_back(pocket);
  }
  return pockets;
}

} // namespace tetvdb
