// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/surface/CompareMeshes.h"

namespace tetvdb::meshes {

/// The Hausdorff distance, sampled.
inline double distanceBetween(const TriangleMesh& a, const TriangleMesh& b) {
  Progress progress;
  return compareMeshes(a, b, {}, progress).hausdorff;
}

} // namespace tetvdb::meshes
