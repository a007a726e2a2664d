// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

/// The thickness of thin walls, world units: the 2 % quantile of the distance straight inward to
/// the next face, over 2000 points spread over the area. Infinity if no face lies behind another.
/// The result does not depend on the number of threads.
double finestThickness(const TriangleMesh& mesh, Progress& progress);

/// The voxel size for remeshing: a third of the finest thickness, at most a 256th of the box's
/// longest side, and large enough for about `maxFaces` faces. Throws Error(Invalid) for a mesh
/// without extent.
double voxelForDetail(const TriangleMesh& mesh, std::size_t maxFaces, Progress& progress);

} // namespace tetvdb
