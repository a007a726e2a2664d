// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/prepared/PreparedJob.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/TetBox.h"
#include "tetvdb/pipeline/StreamJob.h"
#include "tetvdb/pipeline/StreamOptions.h"
#include "tetvdb/pipeline/StreamTrees.h"
#include "tetvdb/pipeline/prepared/PreparedFiles.h"
#include "tetvdb/pipeline/prepared/PreparedTets.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/ChooseTransform.h"

#include <optional>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

void checkPreparedJob(const VoxelizeJob& job) {
  if (job.inputs.size() != 1)
    throw Error(Status::Usage, job.inputs.front(),
                "is a prepared mesh, which is voxelized by itself", "name it alone");
  const auto refuse = [&](const char* setting) {
    throw Error(Status::Usage, setting, "was decided when the mesh was prepared",
                "leave it out, or prepare the mesh again");
  };
  const VoxelizeOptions& options = job.voxelize;
  const CellFilter none;
  if (options.voxelSize != Vec3d{0, 0, 0} || options.fit.voxels != 0 ||
      options.origin != Vec3d{0, 0, 0})
    refuse("`voxel_size`, `origin`, `fit`");
  if (!job.filter.regions.empty() || !job.filter.exclude.empty() ||
      job.filter.boxMin != none.boxMin || job.filter.boxMax != none.boxMax ||
      !job.read.regionArray.empty())
    refuse("`region`, `exclude`, `region_array`, `bbox`");
  if (!job.warp.array.empty())
    refuse("`warp`");
  if (job.smooth)
    refuse("`smooth`");
  if (job.up != UpAxis::Z)
    refuse("`up_axis`");
}

void checkGrids(const VoxelizeJob& job, const PreparedIndex& index) {
  if (index.hasTets)
    return;
  for (const GridKind kind : madeBy(job.grids, {GridMaker::Owner}))
    throw Error(Status::Usage, "`grid`",
                "the mesh was not prepared for " + std::string(infoOf(kind).name),
                "prepare it for this grid");
  if (!job.fields.empty())
    throw Error(Status::Usage, "`grid`", "the mesh was prepared without arrays",
                "prepare it for these grids");
}

SolidFaces facesOf(const std::string& folder, const PreparedIndex& index,
                   std::vector<Vec3d>& points, StageTimer& timer, Progress& progress) {
  timer.part("read");
  SpooledBoundary boundary = readBoundary(folder, index);
  timer.part("snap");
  SolidFaces faces;
  faces.snapped = snapPoints(boundary.points, index.transform, progress);
  faces.chain = std::move(boundary.chain);
  faces.counts = index.counts;
  const auto& p = faces.snapped.points;
  for (const BoundaryFace& face : faces.chain.faces)
    if (boxOf(p[face.a], p[face.b], p[face.c], p[face.c]).extent() > kMaxTetExtent)
      throw Error(Status::Invalid, folder + "/" + index.boundary.name,
                  "has a face longer than 2^20 voxels", "prepare the mesh again");
  points = std::move(boundary.points);
  return faces;
}

} // namespace

VoxelizeResult runPrepared(const VoxelizeJob& asked, Report& report, Progress& progress) {
  checkPreparedJob(asked);
  const std::string folder = asked.inputs.front();
  const PreparedIndex index = readPreparedIndex(folder);
  VoxelizeJob job = asked;
  job.inputs = {index.source}; // for the metadata
  job.up = index.up;
  job.streaming = Streaming::Always;
  if (!canStream(job) && !canStreamTrees(job))
    throw Error(Status::Usage, folder,
                "is a prepared mesh, which is voxelized into .vdb files, found on the CPU, without "
                "a preview or a mesh output",
                "leave the rest out");
  checkGrids(job, index);
  VoxelizeResult result;
  result.inputs = {index.input};
  result.tets = index.input.tets;
  result.volume = index.input.statistics.volume;
  progress.stage("voxelize");
  initializeOpenVDB();
  const bool owners = !madeBy(job.grids, {GridMaker::Owner}).empty();
  const bool byFaces = !madeBy(job.grids, {GridMaker::Distance, GridMaker::Share}).empty() ||
                       (!owners && !madeBy(job.grids, {GridMaker::Occupancy}).empty());
  PreparedInputs inputs;
  inputs.transform = index.transform;
  inputs.mark = index.mark();
  std::optional<PreparedTets> tets;
  {
    StageTimer timer(report, "read");
    if (byFaces)
      inputs.faces.emplace(facesOf(folder, index, inputs.points, timer, progress));
    if (owners || !job.fields.empty()) {
      timer.part("tets");
      inputs.tets = &tets.emplace(folder, index);
    }
    if (!job.fields.empty()) {
      timer.part("arrays");
      FieldOptions wanted = job.fields;
      wanted.turnVectors = job.up == UpAxis::Y;
      inputs.fields = &tets->resolve(wanted, job.fieldRanges.empty() ? nullptr : &job.fieldRanges,
                                     report, progress);
    }
  }
  if (tets)
    tets->requireRoom(streamLimit(job) / 3);
  result.counts = index.counts;
  if (owners)
    result.counts.boundaryFaces = 0; // the grids are found without
  result.transform = index.transform;
  if (canStream(job))
    streamFaces(job, *inputs.faces, index.transform, result, report, progress);
  else
    streamTrees(job, inputs, result, report, progress);
  reportTets(index.counts, index.input.tets, report);
  result.device.name = "cpu";
  return result;
}

} // namespace tetvdb
