// SPDX-License-Identifier: Apache-2.0
//
// Volumes in a cube of N^3 voxels, for programs that require arrays of equal shape.
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <array>

namespace tetvdb {

/// The matrix that maps a voxel's indices (i, j, k, 1), a column, to its centre in world space; by
/// rows.
std::array<std::array<double, 4>, 4> worldFromIndex(const GridTransform& transform);

/// Clips every grid to the voxels (0, 0, 0) to (N - 1, N - 1, N - 1), N = fit.voxels, with
/// the warning ("cut-band") that names the grids which lost active voxels: those of a
/// level set's band. Adds the metadata "fit" and "padding", in voxels, and
/// "world_from_index", the 16 numbers of the matrix by rows. Does nothing if fit.voxels is
/// 0.
void fitVolume(Volume& volume, const GridTransform& transform, const FitBox& fit, Report& report);

} // namespace tetvdb
