// SPDX-License-Identifier: Apache-2.0
//
// The contributions of one face to the pixels of one layer. Internal.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/print/PixelSums.h"

#include <array>

namespace tetvdb {

/// A layer between two heights, millimetres.
struct LayerHeights {
  double bottom = 0, height = 1;
};

/// Adds the face's part within the layer. `weight`: 1 if the face's normal points out of the solid,
/// -1 if it points into it. Corners are in frame coordinates.
void addVolumeOfFace(const std::array<const Vec3d*, 3>& corners, int weight,
                     const LayerHeights& layer, PixelSums& sums);

/// Adds a line of the middle plane's section, with the solid on its left if weight is 1 and on its
/// right if it is -1 (x to the right, y up).
void addAreaOfLine(const std::array<double, 2>& from, const std::array<double, 2>& to, int weight,
                   PixelSums& sums);

/// The point at which the edge from a to b crosses height z, which lies between theirs: independent
/// of the order of a and b.
std::array<double, 2> crossingOfEdge(const Vec3d& a, const Vec3d& b, double z);

} // namespace tetvdb
