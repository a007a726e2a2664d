// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/volume/Grids.h"

namespace tetvdb {

/// Returns the level set "surface" of a shell on one side of a solid: the points at which the
/// solid's signed distance s is from 0 to `thickness` (outward) or from -thickness to 0, world
/// units. Absolute values are those of max(-s, s - thickness) or max(s, -thickness - s): outside of
/// the shell the distance to its surface, inside at most that distance. `distance` is the solid's
/// level set with a half-width of `thickness` plus `halfWidth`, world units; `halfWidth` becomes
/// the background. Signs are those of `shell` (active: inside). Parallel by leaves.
openvdb::FloatGrid::Ptr shellSurface(const openvdb::FloatGrid& distance,
                                     const openvdb::BoolGrid& shell, double thickness, bool outward,
                                     double halfWidth);

} // namespace tetvdb
