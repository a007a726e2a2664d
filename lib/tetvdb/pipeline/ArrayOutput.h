// SPDX-License-Identifier: Apache-2.0
//
// What a job that writes arrays checks before it works.
#pragma once

#include "tetvdb/pipeline/VoxelizeJob.h"
#include "tetvdb/volume/VoxelBox.h"
#include "tetvdb/voxelize/ChooseTransform.h"

namespace tetvdb {

/// Throws Error(Usage) where job.output is an array file whose format has no place for what the job
/// asks for. Volume files pass.
void checkArrayOutput(const VoxelizeJob& job);

/// Voxels with values where the job's meshes are in `box`, and a few more: one box for all frames
/// of a sequence.
VoxelBox arrayBox(const VoxelizeJob& job, const WorldBox& box, const GridTransform& transform);

/// Throws Error(Limit) where job.output is an array file larger than what its disk has room for.
/// `box`: of the meshes. Cost: none, so that it can be asked before the grids are made.
void requireArrayRoom(const VoxelizeJob& job, const WorldBox& box, const GridTransform& transform);

} // namespace tetvdb
