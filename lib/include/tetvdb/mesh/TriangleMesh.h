// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

/// Triangles in world space, as in a file. Indices are in range and coordinates finite; nothing
/// else is assumed. Duplicates, degenerate faces, holes, flips and vertices that no face uses are
/// all allowed; cleanTriangles() (surface/CleanTriangles.h) removes them.
struct TriangleMesh {
  std::vector<Vec3d> points;
  /// Three point indices each. Seen from outside, a face of a solid turns counter-clockwise.
  std::vector<std::uint32_t> triangles;
  /// Faces of the file that were kept: polygons of more than three corners become several
  /// triangles, a fan from their first corner. (As a signed sum a fan is the polygon, concave ones
  /// too.)
  std::size_t faceCount = 0;
  std::string units; ///< "millimetre" and so on where the file says so; empty where it does not

  std::size_t triangleCount() const { return triangles.size() / 3; }
};

} // namespace tetvdb
