// SPDX-License-Identifier: Apache-2.0
//
// Restores creases and corners that marching cubes cuts off.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/volume/Volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The point at which a vertex of marching cubes met the sampled shape.
struct ShapeContact {
  Vec3d point{0, 0, 0};                 ///< world units
  std::array<float, 3> normal{0, 0, 0}; ///< of unit length, outward; 0 if it met nothing
};

/// The triangles of one cube. They are consecutive in the mesh, in the order of the cubes.
struct CubePatch {
  Vec3i cube{0, 0, 0}; ///< its first voxel, index space
  std::uint8_t triangles = 0;
};

/// Extended marching cubes (Kobbelt, Botsch, Schwanecke and Seidel 2001). If the normals at the
/// vertices of a cube differ by more than 25 degrees, its triangles are replaced by a fan around
/// the point closest to all their tangent planes. Edges between two such points replace the edges
/// that cut off the crease. A closed manifold remains one, and vertices that differ as 32-bit
/// floats remain different. Cubes with two surfaces, without contacts, or whose point lies far
/// outside are not changed. Returns the number of added points. Parallel; independent of the number
/// of threads.
std::size_t sharpenCreases(TriangleMesh& mesh, const std::vector<ShapeContact>& contacts,
                           const std::vector<CubePatch>& cubes, const GridTransform& transform,
                           Progress& progress);

} // namespace tetvdb
