// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <string>

namespace tetvdb {

class BoundaryWinding;
class TriangleScene;

struct ExtractOptions {
  std::string grid; ///< name of the grid; empty: the first one whose values define a solid
  /// Limit of the distance that merging triangles moves the surface, in voxels; 0: no merging.
  double simplify = 0.1;
  /// The mesh that the volume was made from: vertices lie on it where a voxel edge crosses it.
  /// Null: a mask's surface lies halfway between voxels, that of a float grid at its isovalue.
  const TriangleScene* original = nullptr;
  /// Of the same mesh on the lattice of the volume's transform, if its inside is where the winding
  /// number is above 0.5: vertices in its holes are placed where it equals 0.5. Null: halfway
  /// between voxels.
  const BoundaryWinding* boundary = nullptr;
  /// World units. Above 0: the solid is the set of points within this distance of `original`, and
  /// vertices are placed at this distance.
  double distance = 0;
  std::size_t maxMemory = 0; ///< bytes; 0: the available memory of the machine
};

/// Extracts the surface of a grid: the boundary of the active voxels of a mask, of values above 0.5
/// of a fog volume, or of values below 0 of a level set. The result is closed, oriented outward and
/// manifold: every edge has two faces in opposite directions, every vertex one fan of faces, and no
/// two vertices are equal as 32-bit floats. It may intersect itself where walls are thinner than a
/// voxel. Deterministic, independent of the number of threads. Throws Error(Invalid) for a grid
/// that defines no solid or is empty, Error(Limit) if the memory does not suffice. `extracted`,
/// unless null, is set to the number of triangles before simplification.
TriangleMesh extractSurface(const Volume& volume, const ExtractOptions& options, Progress& progress,
                            std::size_t* extracted = nullptr);

} // namespace tetvdb
