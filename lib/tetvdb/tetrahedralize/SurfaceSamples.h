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

/// About `count` points, one in every stretch of as much area, and the centroids of all triangles
/// if `centroids`; in order of triangles. Triangles without area get none. Always the same points.
std::vector<SurfaceSample> sampleSurface(const TriangleMesh& mesh, std::size_t count,
                                         bool centroids);

/// Of a sequence of points that fill a box evenly, however many of them are taken.
Vec3d pointInBox(const Box& box, std::size_t i);

} // namespace tetvdb
