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
};

/// The surface between the inside and the outside of a grid: active voxels of a mask, values above
/// 0.5 of a fog volume, below 0 of a level set. The result is closed, oriented outward and
/// manifold: every edge has two faces that run along it in opposite directions, every vertex one
/// fan of faces, and no two vertices are equal even as 32-bit floats. Throws Error(Invalid) for a
/// grid that is no solid or is empty.
TriangleMesh extractSurface(const Volume& volume, const ExtractOptions& options,
                            Progress& progress);

} // namespace tetvdb
