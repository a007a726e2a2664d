// SPDX-License-Identifier: Apache-2.0
//
// The OpenVDB side of DenseGrid.h. Internal.
#pragma once

#include "tetvdb/io/volume/arrays/DenseGrid.h"

#include <memory>
#include <openvdb/openvdb.h>

namespace tetvdb {

/// Throws Error(Usage) for a grid whose type has no array (GridTypes.h lists those that have).
std::unique_ptr<DenseGrid> denseGrid(const openvdb::GridBase& grid, const VoxelBox& box);

} // namespace tetvdb
