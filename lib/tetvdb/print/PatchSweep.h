// SPDX-License-Identifier: Apache-2.0
//
// Regions of successive layers, put together where they are near: surfaces that overhang, walls
// that are thin.
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

/// Connected regions of some layers that follow each other.
struct LayerPatch {
  std::int32_t first = 0, last = 0; ///< layers
  std::int64_t pixels = 0;          ///< of all of them
  std::int64_t largestPixels = 0;   ///< of the layer that has the largest part, the first such
  std::int32_t largestLayer = 0;
  ComponentShape largest; ///< of it the largest component
  PixelBox box;
  double width = 0; ///< the largest of add()'s
};

/// Regions are connected by eight within a layer; those of two layers that follow each other where
/// they come within so many columns and rows of each other.
class PatchSweep {
public:
  PatchSweep(std::int32_t columns, std::int32_t rows) : columns_(columns), rows_(rows) {}

  /// The region of layer k, above the layers before; `region` is labelled by eight neighbours, and
  /// `widths` is empty or has one of each label.
  void add(std::int32_t k, LabelledSpans region, const std::vector<double>& widths = {});
  /// After the last layer.
  void finish();

  /// In the order of their ends.
  const std::vector<LayerPatch>& patches() const { return ended_; }

private:
  std::int32_t columns_, rows_;
  LabelledSpans below_;
  std::vector<LayerPatch> open_, ended_;
  std::vector<std::uint32_t> patchOf_; ///< of each label of below_
};

} // namespace tetvdb
