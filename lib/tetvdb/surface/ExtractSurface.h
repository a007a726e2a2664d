// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <string>

namespace tetvdb {

class TriangleScene;

struct ExtractOptions {
  std::string grid; ///< name of the grid; empty: the first whose values can be a solid
  /// Triangles are merged while the surface moves no more than this, in voxels; 0: none are.
  double simplify = 0.1;
  /// The mesh that the volume came from: vertices lie on it where a voxel edge crosses it. May be
  /// null: then a mask's surface runs midway between voxels and a float grid's along its isovalue.
  const TriangleScene* original = nullptr;
  /// World units; above 0: the solid is not what `original` encloses, but all that is within this
  /// distance of it, and vertices lie where the distance is this.
  double distance = 0;
  std::size_t maxMemory = 0; ///< bytes; 0: what the machine has available
};

/// The surface between the inside and the outside of a grid: active voxels of a mask, values above
/// 0.5 of a fog volume, below 0 of a level set. The result is closed, oriented outward and
/// manifold: every edge has two faces that run along it in opposite directions, every vertex one
/// fan of faces, and no two vertices are equal even as 32-bit floats. It may cut itself where walls
/// are thinner than a voxel. Deterministic for any number of threads. Throws Error(Invalid) for a
/// grid that is no solid or is empty, Error(Limit) where memory does not do.
/// `extracted`, unless null, becomes the number of triangles before simplification.
TriangleMesh extractSurface(const Volume& volume, const ExtractOptions& options, Progress& progress,
                            std::size_t* extracted = nullptr);

} // namespace tetvdb
