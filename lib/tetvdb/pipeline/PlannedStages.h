// SPDX-License-Identifier: Apache-2.0
//
// The expected stages of a job, for the estimate of the remaining time.
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

/// All passes of a volume that is streamed, from the first node to the last byte.
constexpr const char* kStreamStage = "stream";

/// The stages that run() will report, with their shares of the time measured over a dozen meshes
/// from practice at 256 voxels. Reads the kind of the first input; empty if it cannot be
/// determined.
std::vector<PlannedStage> plannedStages(const VoxelizeJob& job);
std::vector<PlannedStage> plannedStages(const TetrahedralizeJob& job);
std::vector<PlannedStage> plannedStages(const RenderJob& job);
std::vector<PlannedStage> plannedStages(const SliceJob& job);
std::vector<PlannedStage> plannedStages(const CheckPrintJob& job);
/// The stages of runSequence(), for any frames.
std::vector<PlannedStage> plannedSequence();

} // namespace tetvdb
