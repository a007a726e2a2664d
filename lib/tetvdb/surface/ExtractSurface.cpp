// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/ExtractSurface.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/surface/MarchingCubes.h"
#include "tetvdb/surface/SimplifySurface.h"
#include "tetvdb/surface/SolidSamples.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {

TriangleMesh extractSurface(const Volume& volume, const ExtractOptions& options,
                            Progress& progress) {
  if (!std::isfinite(options.simplify) || options.simplify < 0)
    throw Error(Status::Usage, "simplify", "must be a number of voxels, zero or more");
  const std::unique_ptr<SolidSamples> samples = solidSamples(volume, options.grid);
  TriangleMesh mesh = marchCubes(*samples, options.original, progress);
  if (mesh.triangles.empty())
    throw Error(Status::Invalid, "", "the grid has no inside, and so no surface");
  const Vec3d& size = samples->transform.voxelSize;
  if (options.simplify > 0)
    simplifySurface(mesh, options.simplify * *std::min_element(size.begin(), size.end()), progress);
  return mesh;
}

} // namespace tetvdb
