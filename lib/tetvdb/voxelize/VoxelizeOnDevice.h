// SPDX-License-Identifier: Apache-2.0
//
// voxelize() on a GPU: the same grids, built by nanovdb_kernels.
#pragma once

#include "tetvdb/geometry/FillRule.h"
#include "tetvdb/volume/NanoBytes.h"
#include "tetvdb/volume/VoxelBox.h"
#include "tetvdb/voxelize/DeviceChoice.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb {

namespace nano {
class DeviceArray;
}

/// Seconds that a job is expected to take; from making the device ready to OpenVDB's trees.
struct DeviceCost {
  double cpu = 0, device = 0;

  bool gains() const { return device <= cpu; }
};
/// `box` and `tets`: boxOfUsed() and tetCount() of the mesh.
DeviceCost estimateCost(const WorldBox& box, std::size_t tets, const GridTransform& transform,
                        const VoxelizeOptions& options);
DeviceCost estimateCost(const TriangleMesh& mesh, const GridTransform& transform,
                        const VoxelizeOptions& options);
/// The same for fields/SampleOnDevice.h and fields of so many numbers a voxel in total.
DeviceCost estimateFieldCost(const TetMesh& mesh, const GridTransform& transform, double numbers);

/// The same for fields/DistanceOnDevice.h and so many leaves of a narrow band and faces.
DeviceCost estimateBandCost(double leaves, double faces);

/// The same for fields/Coverage.h and so many leaves that faces meet.
DeviceCost estimateCoverageCost(double leaves, double faces);

/// Throws Error(Device) where `choice` names a GPU that is not there.
void requireDevice(const DeviceChoice& choice);

/// voxelize() on the device of `choice`. If it is Auto and the device fails or has too little
/// memory, the CPU does the job and the warning "device-left" is added. Adds stages "upload",
/// "voxelize" and "download" to `report` where the GPU is used; making OpenVDB's trees is a part of
/// "download". `nano`, unless null, receives the grids as NanoVDB in place of the volume, which has
/// none then, where the GPU made them and all of them have leaves, else nothing. Throws what
/// voxelize() throws, Error(Device) where the device fails.
Voxelization voxelize(const TetMesh& mesh, const VoxelizeOptions& options,
                      const DeviceChoice& choice, DeviceUsed& used, std::vector<NanoBytes>* nano,
                      Report& report, Progress& progress);

/// The same for triangles. What the GPU cannot do (shells, `flood`, rules but Centre) the CPU does,
/// with the warning "device-unused" where a GPU was asked for. Of soups that do not close, the
/// stage "holes" is added: the CPU fills the holes and finds the leaves in which the winding number
/// may pass a half off the faces; its values there are the GPU's; `nano` receives nothing.
Voxelization voxelize(const TriangleMesh& mesh, const SolidOptions& solid,
                      const VoxelizeOptions& options, const DeviceChoice& choice, DeviceUsed& used,
                      std::vector<NanoBytes>* nano, Report& report, Progress& progress);

/// Occupancy by columns of 4096^3 cubes, on one device (NanoOccupancySource::MakeColumn).
class DeviceColumns {
public:
  /// A mesh of tets, or of triangles that close by `rule`; it must outlive this. Opens the first
  /// device of `choice`, whose name `used` receives. Throws Error(Device).
  DeviceColumns(const TetMesh& mesh, const GridTransform& transform, const DeviceChoice& choice,
                DeviceUsed& used);
  DeviceColumns(const TriangleMesh& mesh, FillRule rule, const GridTransform& transform,
                const DeviceChoice& choice, DeviceUsed& used);
  ~DeviceColumns();

  /// Uploads the mesh and makes the grid of column (x, y), valid until the next call. Throws as
  /// nano::DeviceVoxelizer::run().
  const unsigned char* make(std::int32_t x, std::int32_t y, Progress& progress);

private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The voxels of `box` inside a soup (InsideRule::Winding) as bytes 0 and 1 in the memory of the
/// first device of `choice`, [x][y][z]. Throws Error(Device) where there is none or it fails.
std::shared_ptr<nano::DeviceArray> insideOnDevice(const TriangleMesh& mesh,
                                                  const GridTransform& transform,
                                                  const VoxelBox& box, const DeviceChoice& choice,
                                                  Report& report, Progress& progress);

} // namespace tetvdb
