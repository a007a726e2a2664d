// SPDX-License-Identifier: Apache-2.0
//
// Points spread evenly over triangles, and over a box.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

struct SurfaceSample {
  Vec3d at;
  std::uint32_t triangle;
};

/// About `count` points, one for each interval of equal area, and the centroids of all triangles
/// if `centroids`; in order of triangles. Triangles without area get none. Always the same points.
std::vector<SurfaceSample> sampleSurface(const TriangleMesh& mesh, std::size_t count,
                                         bool centroids);

/// Point i of a sequence that fills a box evenly, for any number of points.
Vec3d pointInBox(const Box& box, std::size_t i);

} // namespace tetvdb
