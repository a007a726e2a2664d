// SPDX-License-Identifier: Apache-2.0
//
// The fog made from a level set: what openvdb::tools::sdfToFogVolume() makes, for parts of a grid
// too. There the depth at which the fog is 1 is that of the whole grid.
#pragma once

#include "tetvdb/volume/Grids.h"

namespace tetvdb {

/// The value of a level set at which its fog is 1, negative: that of the background where an 8^3
/// tile is inside, else the smallest of all voxels. Positive where nothing is inside.
float fogDepth(const openvdb::FloatGrid& levelSet);

/// Turns a level set into the fog volume "fog": 0 outside, rising inside from 0 at the surface to 1
/// at `depth` and beyond. Active where it is not 0; 1 as tiles. Leaves that are 0 are left out.
/// Parallel by 128^3 nodes.
void makeFog(openvdb::FloatGrid& levelSet, float depth);

} // namespace tetvdb
