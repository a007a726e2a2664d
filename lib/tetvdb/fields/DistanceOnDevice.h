// SPDX-License-Identifier: Apache-2.0
//
// The distances of a level set on a GPU: nanovdb_kernels computes them, and the CPU makes the trees
// while leaves are downloaded, by the code for its own distances. Internal.
#pragma once

#include "nanovdb_kernels/DistanceJob.h"
#include "nanovdb_kernels/LevelSetJob.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/fields/LevelSet.h"
#include "tetvdb/voxelize/DeviceSet.h"

#include <tbb/task_arena.h>

namespace tetvdb {

/// Refers to the arrays of both.
nano::FacesView facesViewOf(const SnappedMesh& mesh, const Boundary& boundary);

/// The job of a level set around all faces of a mesh.
nano::LevelSetJob levelSetJobFor(const GridTransform& transform, double halfWidth);

/// The job of a band; refers to the band's arrays, mesh and faces.
nano::DistanceJob distanceJobFor(const DistanceBand& band);

/// Forwards the nodes of a job's batches.
class NodeReceiver : public nano::DistanceReceiver {
public:
  explicit NodeReceiver(const NodeTaker& take) : take_(take) {}
  void take(const nano::DistanceBatch& batch) override;

private:
  const NodeTaker& take_;
  tbb::task_arena arena_{tbb::task_arena::attach()}; // the caller's, also for a device
};

/// rasterizeBand() on `devices`. Throws the errors of nano::DeviceVoxelizer::distances().
void rasterizeBandOn(DeviceSet& devices, const DistanceBand& band, const NodeTaker& take,
                     const Progress& progress);

} // namespace tetvdb
