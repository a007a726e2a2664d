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

// A union of spans of one row, added in any order. Counts the spans that begin and end at every
// cell.
class RowUnion {
public:
  /// Spans lie within these cells.
  RowUnion(std::int32_t begin, std::int32_t end)
      : begin_(begin), changes_(static_cast<std::size_t>(end - begin) + 1, 0) {}

  void add(std::int32_t begin, std::int32_t end) {
    ++changes_[static_cast<std::size_t>(begin - begin_)];
    --changes_[static_cast<std::size_t>(end - begin_)];
  }

  /// Adds the union as row y of `rows` and clears it.
  void finish(std::int32_t y, SpanRows& rows) {
    std::int32_t count = 0, from = 0;
    for (std::size_t i = 0; i < changes_.size(); ++i) {
      if (changes_[i] == 0)
        continue;
      const std::int32_t before = count, at = begin_ + static_cast<std::int32_t>(i);
      count += changes_[i];
      changes_[i] = 0;
      if (before == 0 && count > 0)
        from = at;
      else if (before > 0 && count == 0)
        rows.add(y, from, at);
    }
  }

private:
  std::int32_t begin_;
  std::vector<std::int32_t> changes_;
};

// The columns of all spans, from the first to one past the last.
Span columnsOf(const SpanRows& rows) {
  Span columns{kFar, -kFar};
  for (std::int32_t y = rows.firstRow(); y < rows.endRow(); ++y) {
    const auto [begin, end] = rows.of(y);
    if (begin == end)
      continue;
    columns.begin = std::min(columns.begin, begin->begin);
    columns.end = std::max(columns.end, end[-1].end);
  }
  return columns;
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
  if (solid.empty())
    return cells;
  const Span columns = columnsOf(solid);
  RowUnion inRow(columns.begin / columns_, (columns.end - 1) / columns_ + 1);
  for (std::int32_t row = solid.firstRow() / rows_; row <= (solid.endRow() - 1) / rows_; ++row) {
    for (std::int32_t y = row * rows_; y < (row + 1) * rows_; ++y) {
      const auto [begin, end] = solid.of(y);
      for (const Span* span = begin; span != end; ++span)
        inRow.add(span->begin / columns_, (span->end - 1) / columns_ + 1);
    }
    inRow.finish(row, cells);
  }
  return cells;
}

void DrainPockets::add(std::int32_t k, const SpanRows& cells) {
  const auto at = static_cast<std::size_t>(cellOf(k));
  if (cells_.size() <= at)
    cells_.resize(at + 1);
  cells_[at] = unionOf(cells_[at], cells);
}

std::vector<LayerCavity> DrainPockets::find(Progress& progress) const {
  // Discs of the ball's layers, by their distance from its centre.
  std::vector<PixelDisc> discs;
  for (double z = 0; z < radius_; z += thickness_)
    discs.emplace_back(width_, height_, std::sqrt(radius_ * radius_ - z * z), true);
  const auto reach = static_cast<std::int32_t>(discs.size()) - 1;
  const std::int32_t margin = discs.front().rows();
  const auto count = static_cast<std::int32_t>(cells_.size());

  // The positions that a ball's centre cannot have, in layer k of cells.
  const auto grown = [&](std::int32_t k) {
    SpanRows rows;
    const std::int32_t low = std::max(k - reach, 0), high = std::min(k + reach, count - 1);
    std::int32_t first = kFar, end = -kFar;
    Span columns{kFar, -kFar};
    for (std::int32_t i = low; i <= high; ++i) {
      const SpanRows& cells = cells_[static_cast<std::size_t>(i)];
      if (cells.empty())
        continue;
      first = std::min(first, cells.firstRow() - margin);
      end = std::max(end, cells.endRow() + margin);
      const Span reached = columnsOf(cells);
      columns.begin = std::min(columns.begin, reached.begin - discs.front().reach(0));
      columns.end = std::max(columns.end, reached.end + discs.front().reach(0));
    }
    if (first >= end)
      return rows;
    RowUnion row(columns.begin, columns.end);
    for (std::int32_t y = first; y < end; ++y) {
      for (std::int32_t i = low; i <= high; ++i) {
        const PixelDisc& disc = discs[static_cast<std::size_t>(std::abs(i - k))];
        for (std::int32_t dy = -disc.rows(); dy <= disc.rows(); ++dy) {
          const auto [begin, last] = cells_[static_cast<std::size_t>(i)].of(y + dy);
          const std::int32_t dx = disc.reach(dy);
          for (const Span* span = begin; span != last; ++span)
            row.add(span->begin - dx, span->end + dx);
        }
      }
      row.finish(y, rows);
    }
    return rows;
  };

  LayerFrame frame;
  frame.pixelWidth = width_;
  frame.pixelHeight = height_;
  frame.layerHeight = frame.firstLayerHeight = thickness_;
  // From below the print, where everything is outside.
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
  std::vector<LayerCavity> pockets;
  for (LayerCavity pocket : sweep.cavities()) {
    if (pocket.end != LayerCavity::End::Closed)
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
