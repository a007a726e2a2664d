// SPDX-License-Identifier: Apache-2.0
//
// Contacts of components of two successive layers: those that share a whole side of a
// pixel.
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

/// Each pair once, in order. About 10 ns per span.
std::vector<LayerContact> solidContacts(const LabelledSpans& below, const LabelledSpans& above);

/// Contacts of the void; that of the outside with itself is omitted.
std::vector<LayerContact> voidContacts(const LayerComponents& below, const LayerComponents& above);

/// Pairs within this many columns and rows of each other: 0 and 0 equals solidContacts().
std::vector<LayerContact> nearContacts(const LabelledSpans& below, const LabelledSpans& above,
                                       std::int32_t columns, std::int32_t rows);

} // namespace tetvdb
