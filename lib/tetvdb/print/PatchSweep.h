// SPDX-License-Identifier: Apache-2.0
//
// Connects nearby regions of successive layers: surfaces that overhang, walls that are
// thin.
//
//   tetvdb::PatchSweep sweep(3, 3);
//   for (k = 0; ...)
//     sweep.add(k, region);
//   sweep.finish();
#pragma once

#include "tetvdb/print/LayerComponents.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Connected regions of several successive layers.
struct LayerPatch {
  std::int32_t first = 0, last = 0; ///< layers
  std::int64_t pixels = 0;          ///< in all layers
  std::int64_t largestPixels = 0;   ///< in the layer that has the largest part, the first such
  std::int32_t largestLayer = 0;
  ComponentShape largest; ///< its largest component
  PixelBox box;
  double width = 0; ///< maximum of the widths given to add()
};

/// Regions are connected by eight neighbours within a layer; those of two successive layers if they
/// are within this many columns and rows of each other.
class PatchSweep {
public:
  PatchSweep(std::int32_t columns, std::int32_t rows) : columns_(columns), rows_(rows) {}

  /// Adds the region of layer k, above the previous layers; `region` is labelled by eight
  /// neighbours, and `widths` is empty or has one entry per label.
  void add(std::int32_t k, LabelledSpans region, const std::vector<double>& widths = {});
  /// To be called after the last layer.
  void finish();

  /// In the order of their ends.
  const std::vector<LayerPatch>& patches() const { return ended_; }

private:
  std::int32_t columns_, rows_;
  LabelledSpans below_;
  std::vector<LayerPatch> open_, ended_;
  std::vector<std::uint32_t> patchOf_; ///< by label of below_
};

} // namespace tetvdb
