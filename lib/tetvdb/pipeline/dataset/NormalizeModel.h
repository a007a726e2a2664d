// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/pipeline/dataset/DatasetOptions.h"
#include "tetvdb/pipeline/dataset/SamplePoints.h"

#include <array>

namespace tetvdb {

/// Row by row; columns are multiplied from the right.
using Matrix4 = std::array<double, 16>;

/// A normalised model and its transform.
struct NormalModel {
  Matrix4 transform{};   ///< from the file's coordinates to those of the mesh
  Vec3d centre{0, 0, 0}; ///< of the cube of voxels
  double side = 1;       ///< of the cube: (1 + padding) times the length that counts
};

/// Turns, then scales and moves the points of `mesh` as the options say; `variant` 0 is the model
/// as it is, others are changed at random. The length that becomes 1 is that of the turned model.
/// Throws Error(Invalid) for a mesh without extent.
NormalModel normalizeModel(TriangleMesh& mesh, const DatasetOptions& options, int variant,
                           RandomNumbers& random);

} // namespace tetvdb
