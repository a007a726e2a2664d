// SPDX-License-Identifier: Apache-2.0
//
// Which pixels of a layer belong together: components of the solid, and of the void that the solid
// surrounds.
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

/// Of the void, where the solid is connected by `solid`: with the one by four and the other by
/// eight, a closed curve of the one separates the other (Rosenfeld, 1970).
inline Neighbours complementOf(Neighbours solid) {
  return solid == Neighbours::Four ? Neighbours::Eight : Neighbours::Four;
}

/// How large a component is, and where.
struct ComponentShape {
  std::int64_t pixels = 0;
  PixelBox box;
  std::int32_t x = 0, y = 0; ///< a pixel of it: the middle of its longest span, the first such
};

/// A set of pixels with its components.
struct LabelledSpans {
  SpanRows rows;
  std::vector<std::uint32_t> labels;  ///< of each of rows.spans()
  std::vector<ComponentShape> shapes; ///< of each label
};

/// Label 0 of the void is what is connected with the pixels around the image, which are void; of it
/// no shape is known. Void spans are those between two spans of the solid in a row; all else that
/// is void is outside.
struct LayerComponents {
  LabelledSpans solid, gaps;
};

/// The pixels of a layer that are white: level 128 and more.
SpanRows solidOf(const Layer& layer);

/// Components in the order of their first spans.
LabelledSpans labelled(SpanRows rows, Neighbours neighbours);

/// Of the solid by `neighbours` and of the void by its complement. About 40 ns a span.
LayerComponents componentsOf(SpanRows solid, Neighbours neighbours);

} // namespace tetvdb
