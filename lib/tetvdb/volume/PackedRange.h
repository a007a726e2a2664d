// SPDX-License-Identifier: Apache-2.0
//
// Grids whose leaves know their voxels but hold no values (io/PackedGrid.h), described. Internal.
#pragma once

#include "tetvdb/volume/Volume.h"

#include <cmath>
#include <openvdb/openvdb.h>

namespace tetvdb {

/// A number, or the length of a vector.
template <class T>
double magnitude(const T& value) {
  if constexpr (openvdb::VecTraits<T>::IsVec)
    return std::sqrt(double(value.lengthSqr()));
  else
    return static_cast<double>(value);
}

/// Least and greatest of the values that the leaves would hold; least > most where there are none.
struct PackedRange {
  double least = 0;
  double most = -1;
};

/// describe() of one grid whose leaves with a transientData() other than 0 have no values: those
/// lie in `range`.
GridInfo describePacked(const openvdb::GridBase& grid, const PackedRange& range);

} // namespace tetvdb
