// SPDX-License-Identifier: Apache-2.0
//
// What a job says of a volume's origin, and of how grids are stored, for the file.
#pragma once

#include "tetvdb/pipeline/VoxelizeJob.h"
#include "tetvdb/volume/Grids.h"

#include <map>
#include <string>

namespace tetvdb {

/// The job's own metadata, creator, sources, units and the axis that points up.
std::map<std::string, std::string> originMetadata(const VoxelizeJob& job);

/// Has float grids stored with 16 bits a value where the job asks for it.
void setHalf(const VoxelizeJob& job, const openvdb::GridPtrVec& grids);

/// Makes MaskGrids of BoolGrids where the job asks for them.
void setMaskType(const VoxelizeJob& job, openvdb::GridPtrVec& grids);

} // namespace tetvdb
