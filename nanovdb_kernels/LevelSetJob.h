// SPDX-License-Identifier: Apache-2.0
//
// The input of DeviceVoxelizer::levelSet(): a level set of a closed mesh, or its fog, made on the
// device.
// Contains no type of CUDA or NanoVDB.
#pragma once

#include "DistanceJob.h"
#include "tetvdb/geometry/FillRule.h"

#include <string>

namespace tetvdb::nano {

struct LevelSetJob {
  FillRule rule = FillRule::Positive; ///< winding numbers that are inside; of triangles
  double voxelSize = 1;               ///< world units
  double origin[3] = {0, 0, 0};       ///< world units: the centre of voxel (0, 0, 0)
  double halfWidth = 3;               ///< voxels, at least 1
  /// Distances are those to these, which must contain the surface of the solid. Points that are
  /// null: to the mesh's faces, of tets its boundary, of triangles all, also those inside the
  /// solid.
  FacesView faces;
  bool fog = false;             ///< makes the fog volume of the level set (fields/FogVolume.h)
  std::string name = "surface"; ///< at most 255 bytes
  bool resident = false;        ///< the mesh's arrays are in the device's memory
  bool download = true;         ///< false: the buffer stays on the device
};

} // namespace tetvdb::nano
