// SPDX-License-Identifier: Apache-2.0
//
// sampleFields() and packFields() on a GPU: the same grids. nanovdb_kernels computes owners and
// values, and the CPU makes the trees while leaves are downloaded.
#pragma once

#include "tetvdb/fields/SampleFields.h"
#include "tetvdb/volume/NanoBytes.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <functional>
#include <memory>
#include <vector>

namespace tetvdb::nano {
struct FieldJob; // nanovdb_kernels/FieldJob.h
}

namespace tetvdb {

/// packFields() into `packed` if `pack` is not null, else sampleFields() into `volume`, on
/// the device of `choice`. For Auto, the CPU is used if it is expected to be faster, and if
/// the device fails or has too little memory, with a warning ("device-left"). Float values
/// at points of cells with shape functions (mesh.curved) are computed on the CPU, with a
/// warning ("device-unused") if the GPU was requested. In `report`, stage "fields" has the
/// parts "on the device" (until the first leaves are downloaded) and "values" instead of
/// those of the CPU. Throws the errors of these functions, Error(Device) if the device does
/// not exist or fails; Error(Limit) instead of Error(Invalid) for coordinates that are not
/// finite.
SnapCounts sampleFields(const TetMesh& mesh, const GridTransform& transform,
                        const std::vector<Field>& fields, const SampleOptions& options,
                        const PackOptions* pack, const DeviceChoice& choice, DeviceUsed& used,
                        std::vector<std::unique_ptr<PackedGrid>>& packed, Volume& volume,
                        Report& report, Progress& progress);

/// Whether sampleNanoGrids() can make grids of all `fields`: not by shape functions.
bool makesNanoGrids(const TetMesh& mesh, const std::vector<Field>& fields);

/// sampleFields() whose grids the device makes as NanoVDB's and adds to `grids`; their values,
/// nodes and tiles are the same. Where the CPU is used, or the device's memory is too small for
/// whole grids, adds none, but OpenVDB's grids to `volume()`. In `report`, stage "fields" has the
/// part "on the device".
SnapCounts sampleNanoGrids(const TetMesh& mesh, const GridTransform& transform,
                           const std::vector<Field>& fields, const SampleOptions& options,
                           const DeviceChoice& choice, DeviceUsed& used,
                           std::vector<NanoBytes>& grids, const std::function<Volume&()>& volume,
                           Report& report, Progress& progress);

/// The job for `fields` of `mesh`, to whose arrays it refers; without cells that have shape
/// functions.
nano::FieldJob fieldJobFor(const TetMesh& mesh, const GridTransform& transform,
                           const std::vector<Field>& fields);

} // namespace tetvdb
