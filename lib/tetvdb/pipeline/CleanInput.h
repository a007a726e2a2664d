// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <string>
#include <vector>

namespace tetvdb {

/// cleanTriangles(), with warnings ("inside-out", "flipped-faces") about reversed faces. Messages
/// begin with `name` unless it is empty. Throws Error(Invalid) if no face is left.
CleanCounts cleanInput(TriangleMesh& mesh, const std::string& name, const CleanOptions& options,
                       Report& report, Progress& progress);

/// `options` for a mesh whose solid is asked for: components are closed where the winding number
/// decides what is inside, but not for shells, which have the holes too.
CleanOptions cleaningFor(const SolidOptions& solid, CleanOptions options);

/// The box around the faces of all meshes.
WorldBox boxOf(const std::vector<TriangleMesh>& meshes);
double diagonalOf(const WorldBox& box);

} // namespace tetvdb
