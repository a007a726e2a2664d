// SPDX-License-Identifier: Apache-2.0
//
// Void that only narrow openings lead to: where a ball of some diameter is locked in.
//
//   tetvdb::DrainPockets pockets(frame, 3.5);
//   for (k = 0; ...)
//     pockets.add(k, solid);
//   for (const tetvdb::Cavity& pocket : pockets.find(progress)) ...
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/print/CavitySweep.h"
#include "tetvdb/print/Layer.h"
#include "tetvdb/print/SpanRows.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Works on cells of an eighth of the diameter or, where they are larger, single pixels and layers:
/// solid where any of their pixels is. A place is free where the centres of all solid cells are
/// half the diameter or farther; what of the free places is not connected (by faces) with the
/// outside is a pocket. An opening may be an eighth of the diameter wider or narrower than it is
/// found to be. There is no plate. Memory: 8 bytes for each span of a row of cells, of all layers
/// of cells. Cost: about 20 ns a span of pixels, and for each row
/// of cells 50 times its spans and its length, some ns each.
class DrainPockets {
public:
  /// `diameter` in millimetres, above 0. Layers are all taken to be as high as those above the
  /// first.
  DrainPockets(const LayerFrame& frame, double diameter);

  /// Which layer of cells layer k is in.
  std::int32_t cellOf(std::int32_t k) const { return k / layers_; }
  std::int32_t columns() const { return columns_; } ///< of pixels in a cell
  std::int32_t rows() const { return rows_; }
  std::int32_t layers() const { return layers_; }

  /// A layer's cells, solid where any of its pixels is. Thread-safe.
  SpanRows cellsOf(const SpanRows& solid) const;
  /// Layers in order, from 0 on; `cells` by cellsOf().
  void add(std::int32_t k, const SpanRows& cells);

  /// Pockets, with shapes, boxes and layers in cells, in a CavitySweep's order; their volumes are
  /// those of the free places, in cubic millimetres.
  std::vector<Cavity> find(Progress& progress) const;

private:
  std::int32_t columns_, rows_, layers_;
  double width_, height_, thickness_, radius_; ///< of cells, millimetres
  std::vector<SpanRows> cells_;
};

} // namespace tetvdb
