// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

/// How thick the model is where it is thin, world units: the distance straight inward to the next
/// face, which a fiftieth of 2000 points spread over the area do not reach. Infinity where no face
/// lies behind another. The same for any number of threads.
double finestThickness(const TriangleMesh& mesh, Progress& progress);

/// A voxel that a model is remeshed with: a third of its finest thickness, between a 256th of the
/// box's longest side and what makes about `mostFaces` faces. Throws Error(Invalid) for a mesh
/// without extent.
double voxelForDetail(const TriangleMesh& mesh, std::size_t maxFaces, Progress& progress);

} // namespace tetvdb
