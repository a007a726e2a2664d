// SPDX-License-Identifier: Apache-2.0
//
// The region within a plane's lines, grown or shrunk by a distance, as shares of pixels.
//
//   tetvdb::OffsetRows rows(frame, 0.05, 32);
//   rows.addLine(from, to, 1);                 // all lines of a plane
//   rows.finishPlane(1.0 / 32, sums);
#pragma once

#include "tetvdb/print/Layer.h"
#include "tetvdb/print/PixelSums.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// With S the points whose winding number is above 0, and d the distance: grown by d > 0, the
/// region is the set of points within d of S; shrunk by d < 0, the points of S farther than |d|
/// from its boundary lines. Every row of pixels is sampled along `lines` evenly spaced lines, along
/// which shares are exact: the region is the union (or the difference) of the spans within S and,
/// for each boundary line, the span within |d| of it. Distances are in millimetres, so that pixels
/// may be non-square. Cost: about 50 ns per pair of a boundary line and a line within |d| of each
/// other. Not thread-safe.
class OffsetRows {
public:
  /// `distance` in millimetres, not 0.
  OffsetRows(const LayerFrame& frame, double distance, int lines)
      : frame_(frame), distance_(distance), lines_(lines) {}

  /// Adds a line of S's boundary in pixels, as for addAreaOfLine().
  void addLine(const std::array<double, 2>& from, const std::array<double, 2>& to, int weight);

  /// Adds the region to `sums`, each line with `part` of a pixel; clears the boundary.
  void finishPlane(double part, PixelSums& sums);

private:
  // Along a line: a change of the winding number or of the number of boundary lines nearby.
  struct Change {
    std::int64_t line;
    double x; ///< pixels
    int winding, near;
  };
  void add(std::int64_t line, double x, int winding, int near);

  LayerFrame frame_;
  double distance_;
  int lines_;
  std::vector<Change> changes_;
};

} // namespace tetvdb
