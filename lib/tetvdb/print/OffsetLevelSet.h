// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/Volume.h"

namespace tetvdb {

/// Voxels on either side of a level set's surface within which its values are distances.
constexpr double kOffsetBand = 1.05;

enum class OffsetKept : std::uint8_t { Farther, Nearer };

/// Returns a level set "shape" in voxels, below 0 inside, of the points that are farther than
/// `distance` world units, or closer, by squared distances in voxels from SolidDistances::between()
/// for a range that extends kOffsetBand voxels to either side of it. Parallel by leaves.
openvdb::FloatGrid::Ptr offsetLevelSet(const openvdb::FloatGrid& squared, double distance,
                                       OffsetKept kept, const GridTransform& transform);

} // namespace tetvdb
