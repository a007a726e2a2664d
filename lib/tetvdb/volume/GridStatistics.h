// SPDX-License-Identifier: Apache-2.0
//
// What a grid's metadata say of its tree.
#pragma once

#include <openvdb/openvdb.h>
#include <string>

namespace tetvdb {

/// For a grid that has the metadata of another one, and another tree.
inline void removeStatistics(openvdb::GridBase& grid) {
  using Base = openvdb::GridBase;
  for (const char* name :
       {Base::META_FILE_BBOX_MIN, Base::META_FILE_BBOX_MAX, Base::META_FILE_COMPRESSION,
        Base::META_FILE_MEM_BYTES, Base::META_FILE_VOXEL_COUNT, Base::META_FILE_DELAYED_LOAD})
    grid.removeMeta(name);
}

/// Whether values of a grid of this name are shares of their voxels: coverage, and the levels of
/// detail of what is inside. Its volume is their sum.
bool holdsShares(const std::string& name);

} // namespace tetvdb
