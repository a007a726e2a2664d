// SPDX-License-Identifier: Apache-2.0
//
// Finds islands of a print: components that begin in a layer with nothing below them.
//
//   tetvdb::IslandSweep sweep;
//   for (k = 0; ...)
//     sweep.add(layer.solid, solidContacts(below.solid, layer.solid));
//   for (const tetvdb::Island& island : sweep.islands()) ...
#pragma once

#include "tetvdb/print/LayerComponents.h"
#include "tetvdb/print/LayerContacts.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// A component of the solid of a layer above the first, without solid below any of its pixels.
struct Island {
  std::int32_t layer = 0;
  ComponentShape shape;
  /// The first layer in which it is connected, through layers up to this one, to solid that stands
  /// on the plate; -1: none.
  std::int32_t joins = -1;
  /// The last layer below `joins` that contains a part of the grown component.
  std::int32_t last = 0;
  std::int64_t largestPixels = 0; ///< of the grown component, in one layer up to `last`
};

/// Tracks the components of the solid of layers 0 to k while k grows (the join tree of the height
/// on the solid: Carr, Snoeyink and Axen, 2003). Memory: the components of two layers, and the
/// islands. Cost: about 50 ns per component and contact. Independent of the order of contacts.
class IslandSweep {
public:
  /// Adds the next layer, from 0; `contacts` are those with the previous layer.
  void add(const LabelledSpans& solid, const std::vector<LayerContact>& contacts);

  /// In the order of layers, then of their first spans. Complete after all layers are added.
  const std::vector<Island>& islands() const { return islands_; }

private:
  // A component of all the solid so far.
  struct Body {
    bool stands = false;
    std::vector<std::uint32_t> islands; ///< its islands that have not joined
  };

  std::int32_t k_ = 0;
  std::vector<Body> bodies_;          ///< that reach the last layer
  std::vector<std::uint32_t> bodyOf_; ///< of each component of it
  std::vector<Island> islands_;
};

} // namespace tetvdb
