// SPDX-License-Identifier: Apache-2.0
//
// Creases and corners that marching cubes cuts off.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/volume/Volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Where a vertex of marching cubes met the shape that the samples are of.
struct ShapeContact {
  Vec3d point{0, 0, 0};                 ///< world units
  std::array<float, 3> normal{0, 0, 0}; ///< of unit length, outward; 0 where it met nothing
};

/// The triangles of one cube: they follow one another in the mesh, the cubes in order.
struct CubePatch {
  Vec3i cube{0, 0, 0}; ///< its first voxel, index space
  std::uint8_t triangles = 0;
};

/// Extended marching cubes (Kobbelt, Botsch, Schwanecke and Seidel 2001): where the normals at the
/// vertices of a cube differ by more than 25 degrees, its triangles become a fan around the point
/// next to all their tangent planes, and edges between two such points take the place of those that
/// cut the crease off. Closed and manifold stays closed and manifold, and vertices that differ as
/// 32-bit floats stay different. Cubes with two surfaces, without contacts or whose point lies far
/// outside are left as they are. Returns how many points were added. Parallel; the same for any
/// number of threads.
std::size_t sharpenCreases(TriangleMesh& mesh, const std::vector<ShapeContact>& contacts,
                           const std::vector<CubePatch>& cubes, const GridTransform& transform,
                           Progress& progress);

} // namespace tetvdb
