// SPDX-License-Identifier: Apache-2.0
//
// Checks of jobs that write arrays, before they start.
#pragma once

#include "tetvdb/pipeline/VoxelizeJob.h"
#include "tetvdb/volume/VoxelBox.h"
#include "tetvdb/voxelize/ChooseTransform.h"

namespace tetvdb {

/// Throws Error(Usage) if job.output is an array file whose format does not support the job's
/// options. Accepts volume files.
void checkArrayOutput(const VoxelizeJob& job);

/// The voxels that have values if the job's meshes are in `box`, with a margin: one box for all
/// frames of a sequence.
VoxelBox arrayBox(const VoxelizeJob& job, const WorldBox& box, const GridTransform& transform);

/// Throws Error(Limit) if job.output is an array file that is larger than the free space of its
/// disk. `box`: of the meshes. Fast, so that it can be called before the grids are made.
void requireArrayRoom(const VoxelizeJob& job, const WorldBox& box, const GridTransform& transform);

} // namespace tetvdb
