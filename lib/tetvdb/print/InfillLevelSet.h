// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/print/Infill.h"
#include "tetvdb/volume/Grids.h"

#include <functional>

namespace tetvdb {

/// The thickness of a lattice at a voxel, world units. Thread-safe.
using ThicknessAt = std::function<double(const openvdb::Coord& voxel)>;

/// Returns a level set in voxels, as offsetLevelSet() makes them, below 0 in the part of `cavity`,
/// another level set, outside of the lattice, and above 0 in the lattice, also in the cavity's
/// leaves. Parallel; 50 ns per voxel of the cavity.
openvdb::FloatGrid::Ptr infillLevelSet(const openvdb::FloatGrid& cavity, const Infill& infill,
                                       const ThicknessAt& thickness, Progress& progress);

} // namespace tetvdb
