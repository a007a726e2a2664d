// SPDX-License-Identifier: Apache-2.0
//
// Voxels that become larger where a solid reaches beyond its mesh's box. Internal.
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace tetvdb {

/// The factor by which voxels must become larger for what `made` holds to have no more voxels than
/// options.resolution along any axis, or to keep to the voxels of options.fit; 1: they need not.
double tooFine(const Voxelization& made, const VoxelizeOptions& options);

/// The result of make(options, report). Holes of open meshes that are not flat are closed by
/// surfaces that can lie outside of the mesh's box: where the result has more voxels than
/// options.resolution or options.fit allow, make() is called again, with larger voxels. `report`
/// receives the stages of all calls and the warnings of the last.
template <typename Make>
Voxelization keepResolution(const VoxelizeOptions& options, Report& report, const Make& make) {
  Report own;
  VoxelizeOptions used = options;
  Voxelization made = make(used, own);
  const bool asked = options.voxelSize[0] != 0 || options.rule != VoxelRule::Centre;
  for (double factor = 1; !asked && (factor = tooFine(made, options)) > 1;) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double size = made.transform.voxelSize[k], larger = size * factor;
      used.voxelSize[k] = larger;
      if (options.fit.voxels > 0) // about the same middle
        used.origin[k] = made.transform.origin[k] + (size - larger) * (options.fit.voxels - 1) / 2;
    }
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
