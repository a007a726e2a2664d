// SPDX-License-Identifier: Apache-2.0
//
// The grids of addShapeGrids() as NanoVDB, made on a GPU. Internal.
#pragma once

#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/volume/NanoBytes.h"

#include <memory>
#include <vector>

namespace tetvdb {

namespace nano {
class DeviceArray;
}

/// The grids of addShapeGrids() with these arguments, made on the device of options.device, which
/// has made the mask of the same mesh with `transform`. None where the CPU has to make them: a
/// whole box, shells, InsideRule::Flood, open meshes, coverage of nothing; and for DeviceKind::Auto
/// where the device fails or has too little memory, with the warning "device-left". Adds stage
/// "fields" to `report`. `sums` receives the counts. Throws as addShapeGrids() does.
std::vector<NanoBytes> shapesOnDevice(const TetMesh& mesh, const GridTransform& transform,
                                      const ShapeOptions& options, ShapeSums& sums, Report& report,
                                      Progress& progress);
std::vector<NanoBytes> shapesOnDevice(const TriangleMesh& mesh, const SolidOptions& solid,
                                      const GridTransform& transform, const ShapeOptions& options,
                                      ShapeSums& sums, Report& report, Progress& progress);

/// The values of that level set of triangles at the voxels of `box` as floats in the memory of the
/// only device of options.device, [x][y][z]. Null where there is no such level set or no voxel is
/// inside.
std::shared_ptr<nano::DeviceArray>
distancesOnDevice(const TriangleMesh& mesh, const GridTransform& transform, const VoxelBox& box,
                  const ShapeOptions& options, Report& report, Progress& progress);

} // namespace tetvdb
