// SPDX-License-Identifier: Apache-2.0
//
// Rounds a surface to the precision of files with 32-bit floats, without new intersections.
//
//   tetvdb::FloatRounding rounding = tetvdb::roundToFloats(mesh, progress);
//   if (rounding.crossings > 0)
//     print(rounding.crossings); // pairs of faces that it could not part
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct FloatRounding {
  std::size_t roundedPoints = 0; ///< whose coordinates were no floats
  std::size_t crossingFaces = 0; ///< faces that met others, or had no area, by rounding alone
  std::size_t flippedEdges = 0, contractedEdges = 0, movedPoints = 0; ///< to mend them
  double largestMove = 0;    ///< of a point, and of the surface, by mending; world units
  std::size_t crossings = 0; ///< pairs of faces that still meet, and faces without area
  /// False: faces were not compared, since the mesh is no closed manifold, or points that are equal
  /// as floats could not be separated.
  bool complete = true;
};

/// Rounds the points of a closed manifold to the nearest 32-bit floats. Where faces then meet
/// others (geometry/FaceContact.h), or lose their area, flips edges, moves points by some floats in
/// any direction, or contracts edges, whatever is first to leave fewer such pairs, first within two
/// units of the largest coordinate's last place, then within twice as many, up to 2^11. Separates
/// points that are equal as floats (SeparatePoints.h). Other faces keep their order and corners. A
/// mesh whose coordinates are floats does not change. As countIntersections() of the rounded
/// points' faces, and about 1 ms per face that meets others.
FloatRounding roundToFloats(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
