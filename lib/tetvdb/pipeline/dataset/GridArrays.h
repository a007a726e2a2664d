// SPDX-License-Identifier: Apache-2.0
//
// Converts grids in a cube of N^3 voxels, numbered from (0, 0, 0), to arrays.
#pragma once

#include "tetvdb/pipeline/dataset/NamedArray.h"
#include "tetvdb/volume/Volume.h"

#include <string>

namespace tetvdb {

/// The active voxels of the grid `grid` of `volume` as booleans, shape (N, N, N), packed. Copies
/// whole bytes of leaf masks if N is a multiple of 8.
NamedArray activeArray(const Volume& volume, const std::string& grid, int size, std::string name);
/// Coordinates of the active voxels, int32, shape (M, 3), ascending by x, y, z.
NamedArray coordinateArray(const Volume& volume, const std::string& grid, int size,
                           std::string name);
/// Values of a float grid, shape (N, N, N), those of inactive voxels included.
NamedArray valueArray(const Volume& volume, const std::string& grid, int size, std::string name);

} // namespace tetvdb
