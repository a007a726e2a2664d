// SPDX-License-Identifier: Apache-2.0
//
// OpenVDB's own way from triangles to a level set.
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/volume/Volume.h"

#include <openvdb/openvdb.h>

namespace tetvdb::bench {

/// The call of openvdb::tools::meshToVolume and nothing else: half-width 3, voxels of
/// transform.voxelSize[0].
openvdb::FloatGrid::Ptr meshToVolume(const TriangleMesh& mesh, const GridTransform& transform);

} // namespace tetvdb::bench
