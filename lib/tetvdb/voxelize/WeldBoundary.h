// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/surface/WeldedFaces.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"

namespace tetvdb {

/// Without collinear faces; faces over the same places stay several. About 50 ns a face.
WeldedFaces weldFaces(const SnappedMesh& mesh, const Boundary& boundary, Progress& progress);

} // namespace tetvdb
