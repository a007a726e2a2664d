// SPDX-License-Identifier: Apache-2.0
//
// The OpenVDB side of a Volume. Includes OpenVDB: four seconds of compile time.
#pragma once

#include "tetvdb/volume/Volume.h"

#include <openvdb/openvdb.h>

namespace tetvdb {

struct GridSet {
  openvdb::GridPtrVec all; ///< names unique, one transform
};

/// OpenVDB's linear transform for `transform`: ScaleTranslateMap or ScaleMap, uniform where the
/// three sizes are equal.
openvdb::math::Transform::Ptr makeTransform(const GridTransform& transform);

/// Registers OpenVDB's types once; call before any use of grids or files. Thread-safe, cheap.
void initializeOpenVDB();

} // namespace tetvdb
