// SPDX-License-Identifier: Apache-2.0
//
// sampleFields() and packFields() on a GPU: the same grids. Owners and values are found there, by
// nanovdb_kernels; the trees are made on the CPU as the leaves come down.
#pragma once

#include "tetvdb/fields/SampleFields.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <memory>
#include <vector>

namespace tetvdb::nano {
struct FieldJob; // nanovdb_kernels/FieldJob.h
}

namespace tetvdb {

/// packFields() where `pack` is not null, into `packed`, else sampleFields(), into `volume`; on the
/// device of `choice`. Where that is Auto the CPU takes what it is expected to be faster at, and
/// takes over where the device fails or has too little memory, with a warning ("device-left").
/// Float values at points of cells with shape functions (mesh.curved) are the CPU's: a warning
/// ("device-unused") where the GPU was asked for.
/// Stage "fields" of `report` has the parts "on the device" (until the first leaves come down) and
/// "values" in place of the CPU's.
/// Throws what those throw, Error(Device) where the device is not there or fails; Error(Limit)
/// rather than Error(Invalid) for coordinates that are not finite.
SnapCounts sampleFields(const TetMesh& mesh, const GridTransform& transform,
                        const std::vector<Field>& fields, const SampleOptions& options,
                        const PackOptions* pack, const DeviceChoice& choice, DeviceUsed& used,
                        std::vector<std::unique_ptr<PackedGrid>>& packed, Volume& volume,
                        Report& report, Progress& progress);

/// The job for `fields` of `mesh`, whose arrays it refers to; without cells that have shape
/// functions.
nano::FieldJob fieldJobFor(const TetMesh& mesh, const GridTransform& transform,
                           const std::vector<Field>& fields);

} // namespace tetvdb
