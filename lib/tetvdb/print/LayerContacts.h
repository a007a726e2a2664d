// SPDX-License-Identifier: Apache-2.0
//
// Which components of a layer lie on which of the layer below: those that share a pixel's whole
// side.
#pragma once

#include "tetvdb/print/LayerComponents.h"

#include <cstdint>
#include <tuple>
#include <vector>

namespace tetvdb {

struct LayerContact {
  std::uint32_t below = 0, above = 0; ///< labels
  bool operator<(const LayerContact& o) const {
    return std::tie(below, above) < std::tie(o.below, o.above);
  }
  bool operator==(const LayerContact& o) const { return below == o.below && above == o.above; }
};

/// Each pair once, in order. About 10 ns a span.
std::vector<LayerContact> solidContacts(const LabelledSpans& below, const LabelledSpans& above);

/// Of the void; that of the outside with itself is left out.
std::vector<LayerContact> voidContacts(const LayerComponents& below, const LayerComponents& above);

/// Pairs that come within so many columns and rows of each other: 0 and 0 is solidContacts().
std::vector<LayerContact> nearContacts(const LabelledSpans& below, const LabelledSpans& above,
                                       std::int32_t columns, std::int32_t rows);

} // namespace tetvdb
