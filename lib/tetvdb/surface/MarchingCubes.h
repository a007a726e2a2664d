// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/SharpenCreases.h"
#include "tetvdb/surface/SolidSamples.h"

#include <vector>

namespace tetvdb {

class TriangleScene;

/// What samples were taken of.
struct SampledShape {
  const TriangleScene* scene = nullptr; ///< null: unknown
  double distance = 0;                  ///< above 0: what lies within this distance of the scene
};

/// What creases are found by (SharpenCreases.h).
struct MarchedCubes {
  std::vector<ShapeContact> contacts; ///< of a vertex
  std::vector<CubePatch> cubes;       ///< with triangles
};

/// The closed surface through every pair of neighbouring voxels of which one is inside, one vertex
/// each: on the original where the line between the voxels crosses it, else where the samples say
/// (SolidSamples::passage()), else where the heights pass 0, else midway; always off the voxels by
/// a twentieth of the distance. Manifold, no two vertices equal even as 32-bit floats
/// (docs/algorithms.md says why). Vertices and faces come block by block: the same for any number
/// of threads. Empty where nothing is inside. Parallel, about 1 us a face with an original, a third
/// of it without. Throws Error(Limit) for 2^32 vertices or for a place so far from the origin that
/// floats do not tell the vertices apart. Of `marched`, unless null, the cubes are filled in, and
/// the contacts where the original is known and the shape is what it encloses; elsewhere they are
/// 0.
TriangleMesh marchCubes(const SolidSamples& samples, const SampledShape& original,
                        Progress& progress, MarchedCubes* marched = nullptr);

} // namespace tetvdb
