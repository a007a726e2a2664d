// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Returns for every point the point that replaces it: the first equal point (-0 equals 0). With a
/// `distance` above 0 (world units), each distinct point, in order, is then replaced by the first
/// kept point that is closer than the distance, or is kept. Kept points are therefore never closer
/// than the distance to one another. Parallel for equal points, linear, deterministic.
std::vector<std::uint32_t> weldPoints(const std::vector<Vec3d>& points, double distance,
                                      Progress& progress);

/// The corners of a mesh's triangles after merging equal points.
std::vector<std::uint32_t> weldedCorners(const TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
