// SPDX-License-Identifier: Apache-2.0
//
// Refines and fairs a patch over a hole to match the surrounding surface.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/surface/TriangulatePolygon.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Triangles over a loop of points of a mesh, and the mesh's faces with a point of the loop.
struct HolePatch {
  using Corners = std::array<std::uint32_t, 3>;
  std::vector<Corners> faces;  ///< with points of the loop only
  std::vector<Corners> around; ///< with the orientation of `faces`
};

/// What the new points of a patch minimize, by cotangents.
enum class Fairness {
  Smooth, ///< the squared Laplacian, by area, of the patch and of its boundary, including the faces
          ///< around it: the surface continues the tangent planes of its surroundings
  Taut    ///< the squared lengths of edges: the surface is nearly one of the smallest area
};

/// Refines the patch: splits a face into three if its centroid is farther from its corners than the
/// local edge length, and flips inner edges whose opposite angles are larger (P. Liepa, Filling
/// holes in meshes, 2003). Then moves the new points to where the patch is fair. Appends them to
/// `points`. Does not make edges for which `isTaken` holds. Returns the number of new points.
/// Returns 0, and changes nothing, if the patch is fine enough, is larger than kMaxFairPoints, or
/// no such surface was found. About 1 ms per hundred points.
std::size_t fairPatch(std::vector<Vec3d>& points, HolePatch& patch, Fairness fairness,
                      const EdgeTaken& isTaken, Progress& progress);

constexpr std::size_t kMaxFairPoints = 100000;

} // namespace tetvdb
