// SPDX-License-Identifier: Apache-2.0
//
// Describes grids whose leaves have masks but no values (io/volume/PackedGrid.h). Internal.
#pragma once

#include "tetvdb/volume/Volume.h"

#include <cmath>
#include <openvdb/openvdb.h>

namespace tetvdb {

/// A number, or the length of a vector.
template <class T>
double scalarValue(const T& value) {
  if constexpr (openvdb::VecTraits<T>::IsVec)
    return std::sqrt(double(value.lengthSqr()));
  else
    return static_cast<double>(value);
}

/// The range of the values that the leaves would hold; min > max where there are none.
struct PackedRange {
  double min = 0;
  double max = -1;
};

/// describe() of one grid whose leaves with a transientData() other than 0 have no values: those
/// lie in `range`.
GridInfo describePacked(const openvdb::GridBase& grid, const PackedRange& range);

} // namespace tetvdb
