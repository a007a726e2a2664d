// SPDX-License-Identifier: Apache-2.0
//
// A patch over a hole made as fine and as smooth as the surface around it.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/surface/TriangulatePolygon.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Triangles over a loop of points of a mesh, and the mesh's faces that have a point of the loop.
struct HolePatch {
  using Corners = std::array<std::uint32_t, 3>;
  std::vector<Corners> faces;  ///< over the loop's points alone
  std::vector<Corners> around; ///< as oriented as `faces`
};

/// Refines the patch: a face whose middle is farther from its corners than edges there are long is
/// split in three, and inner edges are flipped where the angles opposite to them are larger (P.
/// Liepa, Filling holes in meshes, 2003). Then moves the new points to where the squared Laplacian
/// (cotangents, by area) of the patch and of its boundary, faces around it included, is least: the
/// surface goes on with the same tangent and bends evenly. New points are appended to `points`.
/// Edges that are taken are not made. Returns how many points there are; 0: nothing was changed, as
/// the patch is fine enough, or larger than kMaxFairPoints, or no such surface was found. About 1
/// ms for a hundred points.
std::size_t fairPatch(std::vector<Vec3d>& points, HolePatch& patch, const EdgeTaken& isTaken,
                      Progress& progress);

constexpr std::size_t kMaxFairPoints = 20000;

} // namespace tetvdb
