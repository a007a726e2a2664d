// SPDX-License-Identifier: Apache-2.0
//
// Finds void that is reached only through narrow openings: a ball of some diameter cannot leave it.
//
//   tetvdb::DrainPockets pockets(frame, 3.5);
//   for (k = 0; ...)
//     pockets.add(k, solid);
//   for (const tetvdb::LayerCavity& pocket : pockets.find(progress)) ...
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/print/CavitySweep.h"
#include "tetvdb/print/Layer.h"
#include "tetvdb/print/SpanRows.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Works on cells of an eighth of the diameter or, if they are larger, single pixels and layers. A
/// cell is solid if any of its pixels is. A position is free if the centres of all solid cells are
/// at half the diameter or farther. Free positions that are not connected (by faces) to the outside
/// are pockets. An opening may be an eighth of the diameter wider or narrower than computed. The
/// plate is not included. Memory: 8 bytes per span of a row of cells, for all layers of cells.
/// Cost: about 20 ns per span of pixels, and per row of cells several ns times 50 times its spans
/// and its length.
class DrainPockets {
public:
  /// `diameter` in millimetres, above 0. All layers are assumed to be as high as those above the
  /// first.
  DrainPockets(const LayerFrame& frame, double diameter);

  /// The layer of cells that contains layer k.
  std::int32_t cellOf(std::int32_t k) const { return k / layers_; }
  std::int32_t columns() const { return columns_; } ///< pixels per cell
  std::int32_t rows() const { return rows_; }
  std::int32_t layers() const { return layers_; }

  /// The cells of a layer, solid if any of their pixels is. Thread-safe.
  SpanRows cellsOf(const SpanRows& solid) const;
  /// Adds layers in order, from 0; `cells` by cellsOf().
  void add(std::int32_t k, const SpanRows& cells);

  /// Pockets, with shapes, boxes and layers in cells, in the order of a CavitySweep; their volumes
  /// are those of the free positions, in cubic millimetres.
  std::vector<LayerCavity> find(Progress& progress) const;

private:
  std::int32_t columns_, rows_, layers_;
  double width_, height_, thickness_, radius_; ///< of cells, millimetres
  std::vector<SpanRows> cells_;
};

} // namespace tetvdb
