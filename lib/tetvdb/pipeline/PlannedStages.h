// SPDX-License-Identifier: Apache-2.0
//
// Which stages a job will go through, for the time that is left.
//
//   tetvdb::TimeEstimate estimate;
//   estimate.plan(tetvdb::plannedStages(job), seconds());
//   progress.onReport([&](std::string_view stage, double fraction) {
//     estimate.update(stage, fraction, seconds());
//     show(estimate.done(), estimate.left());
//   });
#pragma once

#include "tetvdb/core/TimeEstimate.h"
#include "tetvdb/pipeline/CheckPrintJob.h"
#include "tetvdb/pipeline/RenderJob.h"
#include "tetvdb/pipeline/SliceJob.h"
#include "tetvdb/pipeline/TetrahedralizeJob.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <vector>

namespace tetvdb {

/// The stages that run() will report, with the shares of the job's time that they took over a dozen
/// meshes of the wild at 256 voxels. Looks at what the first input holds; empty where that cannot
/// be told.
std::vector<PlannedStage> plannedStages(const VoxelizeJob& job);
std::vector<PlannedStage> plannedStages(const TetrahedralizeJob& job);
std::vector<PlannedStage> plannedStages(const RenderJob& job);
std::vector<PlannedStage> plannedStages(const SliceJob& job);
std::vector<PlannedStage> plannedStages(const CheckPrintJob& job);
/// Of runSequence(), whatever its frames are.
std::vector<PlannedStage> plannedSequence();

} // namespace tetvdb
