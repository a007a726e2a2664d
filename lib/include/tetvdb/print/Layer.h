// SPDX-License-Identifier: Apache-2.0
//
// One layer of a print: rows of runs of equal pixels, and the closed lines around its solid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tetvdb {

/// The pixels and layers into which a solid is cut. Pixel (x, y) of layer k is the box from x to x
/// + 1, y to y + 1 of the image, row 0 at the top, and from bottomOf(k) to bottomOf(k + 1).
struct LayerFrame {
  std::int32_t width = 0, height = 0; ///< pixels
  double pixelWidth = 0;              ///< millimetres
  double pixelHeight = 0;             ///< millimetres
  double layerHeight = 0;             ///< millimetres
  double firstLayerHeight = 0;        ///< millimetres
  std::int32_t layers = 0;

  /// Millimetres above the plate.
  double bottomOf(std::int32_t layer) const {
    return layer == 0 ? 0 : firstLayerHeight + layerHeight * (layer - 1);
  }
  double heightOf(std::int32_t layer) const { return layer == 0 ? firstLayerHeight : layerHeight; }
};

/// Pixels begin to end - 1 of a row.
struct PixelRun {
  std::int32_t begin = 0, end = 0;
  std::uint8_t value = 0; ///< a grey level, or the number of a material
};

/// The position of a row's first run in Layer::runs, which end at those of the next row.
struct LayerRow {
  std::int32_t y = 0;
  std::size_t first = 0;
};

/// A closed line in millimetres on the plate, y up, without repetition of its first point. The
/// solid is on the left: outer lines are counter-clockwise, those around holes clockwise.
using LayerContour = std::vector<std::array<double, 2>>;

/// The pixels of a layer that are not 0. Rows ascend and have at least one run; the runs of a row
/// ascend, do not touch if their values are equal, and have values above 0.
struct Layer {
  std::vector<LayerRow> rows;
  std::vector<PixelRun> runs;
  std::vector<LayerContour> contours; ///< set only by sources of contours, instead of rows
  double filled = 0;                  ///< sum of the shares before they are rounded, pixels
  double overlap = 0;                 ///< sum of the excess of shares above 1, where solids overlap

  void clear() {
    rows.clear();
    runs.clear();
    contours.clear();
    filled = overlap = 0;
  }
  bool empty() const { return runs.empty() && contours.empty(); }

  /// Appends a run after all existing ones, merged with the last if it continues it. Values of 0
  /// are ignored.
  void add(std::int32_t y, std::int32_t begin, std::int32_t end, std::uint8_t value) {
    if (value == 0 || begin >= end)
      return;
    if (rows.empty() || rows.back().y != y)
      rows.push_back({y, runs.size()});
    else if (PixelRun& last = runs.back(); last.end == begin && last.value == value) {
      last.end = end;
      return;
    }
    runs.push_back({begin, end, value});
  }

  /// The runs of rows[i], as a pair of pointers.
  std::pair<const PixelRun*, const PixelRun*> runsOf(std::size_t i) const {
    const std::size_t last = i + 1 < rows.size() ? rows[i + 1].first : runs.size();
    return {runs.data() + rows[i].first, runs.data() + last};
  }
};

} // namespace tetvdb
