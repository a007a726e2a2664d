// SPDX-License-Identifier: Apache-2.0
//
// Enlarges voxels where a solid reaches beyond its mesh's box. Internal.
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/volume/VoxelBox.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace tetvdb {

/// The factor by which voxels must become larger for a solid in `box` to have no more voxels than
/// options.resolution along any axis, or to keep to the voxels of options.fit; 1: they need not.
double tooFine(const VoxelBox& box, const VoxelizeOptions& options);
/// The same for the voxels of `made`, which lie within the mesh's box if its faces close.
double tooFine(const Voxelization& made, const VoxelizeOptions& options);

/// Whether voxels may become larger: where their size and rule are not given.
inline bool mayCoarsen(const VoxelizeOptions& options) {
  return options.voxelSize[0] == 0 && options.rule == VoxelRule::Centre;
}
/// Makes the voxels of `used` larger than those of `transform`.
void coarsen(const GridTransform& transform, double factor, VoxelizeOptions& used);

/// The result of make(options, report). Holes of open meshes that are not flat are closed by
/// surfaces that can lie outside of the mesh's box: where the result has more voxels than
/// options.resolution or options.fit allow, make() is called again, with larger voxels. `report`
/// receives the stages of all calls and the warnings of the last.
template <typename Make>
Voxelization keepResolution(const VoxelizeOptions& options, Report& report, const Make& make) {
  Report own;
  VoxelizeOptions used = options;
  Voxelization made = make(used, own);
  for (double factor = 1; mayCoarsen(options) && (factor = tooFine(made, options)) > 1;) {
    coarsen(made.transform, factor, used);
    own.warnings.clear();
    own.partial = false;
    made = make(used, own);
  }
  std::move(own.stages.begin(), own.stages.end(), std::back_inserter(report.stages));
  std::move(own.warnings.begin(), own.warnings.end(), std::back_inserter(report.warnings));
  report.partial = report.partial || own.partial;
  return made;
}

} // namespace tetvdb
