// SPDX-License-Identifier: Apache-2.0
//
// Islands of a print: what begins in a layer with nothing below it.
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

/// A component of the solid of a layer above the first, below none of whose pixels there is solid.
struct Island {
  std::int32_t layer = 0;
  ComponentShape shape;
  /// The first layer in which it is connected, through what is at most as high, with solid that
  /// stands on the plate; -1: in none.
  std::int32_t joins = -1;
  /// The last layer below `joins` that has a part of what it has grown to.
  std::int32_t last = 0;
  std::int64_t largestPixels = 0; ///< of what it has grown to, in one layer up to `last`
};

/// Follows the components of the solid of layers 0 to k while k grows (the join tree of the height
/// on the solid: Carr, Snoeyink and Axen, 2003). Memory: the components of two layers, and the
/// islands. Cost: about 50 ns a component and contact. Does not depend on the order of contacts.
class IslandSweep {
public:
  /// The next layer, from 0 on; `contacts` are those with the layer before.
  void add(const LabelledSpans& solid, const std::vector<LayerContact>& contacts);

  /// In the order of layers, then of their first spans. Complete once all layers have been added.
  const std::vector<Island>& islands() const { return islands_; }

private:
  // A component of all the solid so far.
  struct Body {
    bool stands = false;
    std::vector<std::uint32_t> islands; ///< those of it that have not joined
  };

  std::int32_t k_ = 0;
  std::vector<Body> bodies_;          ///< that reach the last layer
  std::vector<std::uint32_t> bodyOf_; ///< of each component of it
  std::vector<Island> islands_;
};

} // namespace tetvdb
