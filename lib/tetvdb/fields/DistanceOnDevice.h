// SPDX-License-Identifier: Apache-2.0
//
// The distances of a level set on a GPU: nanovdb_kernels finds them, the trees are made on the CPU
// as the leaves come down, by the code that makes them of the CPU's. Internal.
#pragma once

#include "nanovdb_kernels/DistanceJob.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/fields/LevelSet.h"
#include "tetvdb/voxelize/DeviceSet.h"

#include <tbb/task_arena.h>

namespace tetvdb {

/// The job of a band, whose arrays, mesh and faces it refers to.
nano::DistanceJob distanceJobFor(const DistanceBand& band);

/// Hands the nodes of a job's batches on.
class NodeReceiver : public nano::DistanceReceiver {
public:
  explicit NodeReceiver(const NodeTaker& take) : take_(take) {}
  void take(const nano::DistanceBatch& batch) override;

private:
  const NodeTaker& take_;
  tbb::task_arena arena_{tbb::task_arena::attach()}; // the caller's, for a device's thread too
};

/// rasterizeBand() on `devices`. Throws what nano::DeviceVoxelizer::distances() throws.
void rasterizeBandOn(DeviceSet& devices, const DistanceBand& band, const NodeTaker& take,
                     const Progress& progress);

} // namespace tetvdb
