// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/SharpenCreases.h"
#include "tetvdb/surface/SolidSamples.h"

#include <vector>

namespace tetvdb {

class BoundaryWinding;
class TriangleScene;

/// The shape from which samples were taken.
struct SampledShape {
  const TriangleScene* scene = nullptr;      ///< null: unknown
  const BoundaryWinding* boundary = nullptr; ///< of the scene, if that decides; null: it is closed
  double distance = 0; ///< above 0: all points within this distance of the scene
};

/// Input of sharpenCreases() (SharpenCreases.h).
struct MarchedCubes {
  std::vector<ShapeContact> contacts; ///< by vertex
  std::vector<CubePatch> cubes;       ///< those with triangles
};

/// Returns the closed surface with one vertex between every two neighbouring voxels of which
/// exactly one is inside. The vertex lies on the original surface if the line between the voxels
/// crosses it, else where the winding number passes 0.5, else at SolidSamples::passage(), else
/// where the heights pass 0, else at the midpoint; always at least a twentieth of the distance from
/// either voxel. Manifold; no two vertices are equal as 32-bit floats (docs/algorithms.md has the
/// proof). Vertices and faces are in the order of the blocks, independent of the number of threads.
/// Empty if nothing is inside. Parallel, about 1 us per face with an original, a third of it
/// without. Throws Error(Limit) for 2^32 vertices, or if the position is so far from the origin
/// that floats cannot distinguish the vertices. Unless null, `marched` receives the cubes, and the
/// contacts if the original is known and the shape is its inside; otherwise the contacts are 0.
TriangleMesh marchCubes(const SolidSamples& samples, const SampledShape& original,
                        Progress& progress, MarchedCubes* marched = nullptr);

} // namespace tetvdb
