// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// For every point the one that it becomes: the first point that is equal (-0 equals 0). With a
/// `distance` above 0 (world units), the distinct points are then gone through in order, and each
/// becomes the first point kept so far that is nearer than that; points that are kept are
/// therefore never nearer to one another. Parallel for equal points, linear, deterministic.
std::vector<std::uint32_t> weldPoints(const std::vector<Vec3d>& points, double distance,
                                      Progress& progress);

/// The corners of a mesh's triangles, points that are equal being one.
std::vector<std::uint32_t> weldedCorners(const TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
