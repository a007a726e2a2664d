// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/volume/Grids.h"

namespace tetvdb {

/// The level set "surface" of a shell on one side of a solid: where the solid's signed distance s
/// is from 0 to `thickness` (outward) or from -thickness to 0, world units. Magnitudes are those of
/// max(-s, s - thickness) or max(s, -thickness - s): outside of the shell, and at most that within,
/// the distance to its surface. `distance` is the solid's level set, its half-width the thickness
/// more than `halfWidth`, world units, which becomes the background; signs are those of `shell`
/// (active: inside). Parallel by leaves.
openvdb::FloatGrid::Ptr shellSurface(const openvdb::FloatGrid& distance,
                                     const openvdb::BoolGrid& shell, double thickness, bool outward,
                                     double halfWidth);

} // namespace tetvdb
