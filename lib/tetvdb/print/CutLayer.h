// SPDX-License-Identifier: Apache-2.0
//
// One face within one layer: what it adds to the pixels. Internal.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/print/PixelSums.h"

#include <array>

namespace tetvdb {

/// A layer between two heights, millimetres.
struct LayerHeights {
  double bottom = 0, height = 1;
};

/// Adds the face's part within the layer. `weight`: 1 where the face's normal points out of the
/// solid, -1 where it points into it. Corners in frame coordinates.
void addVolumeOfFace(const std::array<const Vec3d*, 3>& corners, int weight,
                     const LayerHeights& layer, PixelSums& sums);

/// Adds a line of a middle plane's cut, the solid on its left where weight is 1 and on its right
/// where it is -1 (x to the right, y up).
void addAreaOfLine(const std::array<double, 2>& from, const std::array<double, 2>& to, int weight,
                   PixelSums& sums);

/// Where the edge from a to b passes height z, which lies between theirs: the same point whichever
/// end comes first.
std::array<double, 2> crossingOfEdge(const Vec3d& a, const Vec3d& b, double z);

} // namespace tetvdb
