// SPDX-License-Identifier: Apache-2.0
//
// Components of a layer's pixels: of the solid, and of the void that the solid
// encloses.
//
//   tetvdb::LayerComponents layer =
//       tetvdb::componentsOf(tetvdb::solidOf(pixels), tetvdb::Neighbours::Eight);
#pragma once

#include "tetvdb/print/Layer.h"
#include "tetvdb/print/PixelBox.h"
#include "tetvdb/print/SpanRows.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// The neighbours of the void if the solid is connected by `solid`: with four for one and eight for
/// the other, a closed curve of one separates the other (Rosenfeld, 1970).
inline Neighbours complementOf(Neighbours solid) {
  return solid == Neighbours::Four ? Neighbours::Eight : Neighbours::Four;
}

/// The size and position of a component.
struct ComponentShape {
  std::int64_t pixels = 0;
  PixelBox box;
  std::int32_t x = 0, y = 0; ///< one of its pixels: the middle of its longest span, the first such
};

/// A set of pixels with its components.
struct LabelledSpans {
  SpanRows rows;
  std::vector<std::uint32_t> labels;  ///< by span of rows.spans()
  std::vector<ComponentShape> shapes; ///< by label
};

/// Label 0 of the void is the component connected to the pixels around the image, which are void;
/// its shape is not computed. Void spans are those between two spans of the solid in a row; all
/// other void is outside.
struct LayerComponents {
  LabelledSpans solid, gaps;
};

/// The white pixels of a layer: level 128 and more.
SpanRows solidOf(const Layer& layer);

/// Components in the order of their first spans.
LabelledSpans labelled(SpanRows rows, Neighbours neighbours);

/// Components of the solid by `neighbours` and of the void by the complement. About 40 ns per span.
LayerComponents componentsOf(SpanRows solid, Neighbours neighbours);

} // namespace tetvdb
