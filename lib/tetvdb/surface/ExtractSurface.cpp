// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/ExtractSurface.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/surface/MarchingCubes.h"
#include "tetvdb/surface/SimplifySurface.h"
#include "tetvdb/surface/SolidSamples.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {

namespace {
constexpr std::size_t kSimplifyBytes = 480; ///< per triangle, measured
}

TriangleMesh extractSurface(const Volume& volume, const ExtractOptions& options, Progress& progress,
                            std::size_t* extracted) {
  if (!std::isfinite(options.simplify) || options.simplify < 0)
    throw Error(Status::Usage, "simplify", "must be a number of voxels, zero or more");
  const std::unique_ptr<SolidSamples> samples = solidSamples(volume, options.grid);
  MarchedCubes marched;
  const bool isKnown = options.original != nullptr && options.distance == 0;
  TriangleMesh mesh = marchCubes(*samples, {options.original, options.boundary, options.distance},
                                 progress, isKnown ? &marched : nullptr);
  if (mesh.triangles.empty())
    throw Error(Status::Invalid, "", "the grid has no inside, and so no surface");
  if (isKnown)
    sharpenCreases(mesh, marched.contacts, marched.cubes, samples->transform, progress);
  if (extracted != nullptr)
    *extracted = mesh.triangleCount();
  const Vec3d& size = samples->transform.voxelSize;
  if (options.simplify == 0)
    return mesh;
  const std::size_t memory = options.maxMemory > 0 ? options.maxMemory : availableBytes();
  if (memory / kSimplifyBytes < mesh.triangleCount())
    throw Error(Status::Limit, "",
                "the surface has " + std::to_string(mesh.triangleCount()) +
                    " triangles, too many to be simplified in memory",
                "use larger voxels, or `simplify=0`");
  progress.stage("simplify");
  SimplifyOptions simplify;
  simplify.tolerance = options.simplify * *std::min_element(size.begin(), size.end());
  simplifySurface(mesh, simplify, progress);
  return mesh;
}

} // namespace tetvdb
