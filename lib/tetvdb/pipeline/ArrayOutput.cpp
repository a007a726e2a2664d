// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/ArrayOutput.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/ArrayFile.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

// Voxels by which a level set's band, a shell or a rule extends the mesh on every side.
double marginOf(const VoxelizeJob& job, const GridTransform& transform) {
  double margin = 1;
  if (!madeBy(job.grids, {GridMaker::Distance}).empty())
    margin = std::max(margin,
                      job.shapes.halfWidth == kWholeBox ? 4 : std::ceil(job.shapes.halfWidth) + 1);
  const Vec3d& h = transform.voxelSize;
  return margin + std::ceil(job.solid.shell / 2 / std::min({h[0], h[1], h[2]}));
}

VoxelBox grown(const WorldBox& box, const GridTransform& transform, double margin) {
  // End of index space for arrays.
  constexpr double kFarthest = 1 << 30;
  VoxelBox voxels;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double h = transform.voxelSize[axis], origin = transform.origin[axis];
    const double low = std::ceil((box.min[axis] - origin) / h) - margin;
    const double high = std::floor((box.max[axis] - origin) / h) + margin;
    voxels.low[axis] = static_cast<std::int32_t>(std::clamp(low, -kFarthest, kFarthest));
    voxels.high[axis] = static_cast<std::int32_t>(std::clamp(high, -kFarthest, kFarthest));
  }
  return voxels;
}

std::size_t gridsOf(const VoxelizeJob& job) {
  // The number of arrays for `all` is known after reading the mesh: at least one.
  return job.grids.size() + job.fields.requests.size() + (job.fields.all ? 1 : 0);
}

} // namespace

void checkArrayOutput(const VoxelizeJob& job) {
  if (!isArrayFile(job.output))
    return;
  checkArrayOptions(job.output, job.arrays, gridsOf(job));
  if (job.half)
    throw Error(Status::Usage, "`half`", "applies to .vdb and .nvdb only; arrays store full values",
                "leave it out");
}

VoxelBox arrayBox(const VoxelizeJob& job, const WorldBox& box, const GridTransform& transform) {
  return grown(box, transform, marginOf(job, transform));
}

void requireArrayRoom(const VoxelizeJob& job, const WorldBox& box, const GridTransform& transform) {
  if (!isArrayFile(job.output) || job.arrays.sparse)
    return;
  const VoxelBox voxels = job.arrays.box ? *job.arrays.box : grown(box, transform, 0);
  const double bytes = 4 * static_cast<double>(gridsOf(job)) -
                       (contains(job.grids, GridKind::Mask) ? 3 : 0); // of a voxel
  requireRoom(job.output, voxels.voxels() * bytes, job.arrays.compress);
}

} // namespace tetvdb
