// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/TetrahedralizeJob.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/pipeline/CleanInput.h"
#include "tetvdb/pipeline/MergeMeshes.h"
#include "tetvdb/pipeline/Preview.h"
#include "tetvdb/surface/LocalRepair.h"
#include "tetvdb/surface/MeshChanges.h"

#include <algorithm>
#include <utility>

namespace tetvdb {
namespace {

void checkJob(const TetrahedralizeJob& job) {
  if (job.inputs.empty())
    throw Error(Status::Usage, "", "no input was given");
  if (job.output.empty() && !job.keep)
    throw Error(Status::Usage, "", "no output was given", "name one by `output`");
  if (!job.output.empty()) {
    requireFormat(job.output, {FormatUse::WriteTets});
    requireWritable(job.output);
  }
  checkPreviewPath(job.preview);
  requireSeparateFiles(filesAmong(job.inputs, job.memory), {job.output, job.preview});
  for (const RelativeLength& length : {job.epsilon, job.edgeLength})
    if (length.value != 0 && length.unit == RelativeLength::Unit::Voxel)
      throw Error(Status::Usage, "`epsilon`, `edge_length`",
                  "are given in voxels, but no voxels are made",
                  "give a length, or a share of the diagonal such as 1e-3d");
}

std::vector<TriangleMesh> readAll(const TetrahedralizeJob& job, TetrahedralizeResult& result,
                                  Report& report, Progress& progress) {
  StageTimer timer(report, "read");
  progress.stage("read");
  for (const std::string& input : job.inputs)
    if (!holdsTriangles(input, job.memory))
      throw Error(Status::Usage, input, "holds no triangles",
                  "give " + endingList(FormatUse::ReadTriangles) +
                      " files; 'tetvdb repair' makes one of the surface of tetrahedra");
  std::vector<TriangleMesh> meshes;
  for (const std::string& input : job.inputs) {
    InputInfo info;
    timer.part(input);
    meshes.push_back(readSoup(input, &info, report, progress, job.memory));
    result.inputs.push_back(std::move(info));
  }
  haveOneUnit(meshes, report);
  return meshes;
}

void cleanAll(const TetrahedralizeJob& job, std::vector<TriangleMesh>& meshes,
              TetrahedralizeResult& result, Report& report, Progress& progress) {
  StageTimer timer(report, "clean");
  progress.stage("clean");
  const CleanOptions clean = cleaningFor(SolidOptions{}, job.clean);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    timer.part(job.inputs[i]);
    result.cleaned.push_back(cleanInput(meshes[i], job.inputs[i], clean, report, progress));
    result.cleanedFaces.push_back(meshes[i].triangleCount());
  }
}

std::map<std::int32_t, std::string> regionNames(const TetrahedralizeJob& job) {
  switch (job.mesher.boolean) {
  case Boolean::Materials:
    break;
  case Boolean::Union:
    return {{1, "union"}};
  case Boolean::Difference:
    return {{1, "difference"}};
  case Boolean::Intersection:
    return {{1, "intersection"}};
  }
  std::map<std::int32_t, std::string> names;
  for (const std::string& name : uniqueStems(job.inputs))
    names[static_cast<std::int32_t>(names.size()) + 1] = name;
  return names;
}

// Replaces meshes by their repaired surfaces; returns whether any was.
bool repairAll(std::vector<TriangleMesh>& meshes, TetrahedralizeResult& result, Report& report,
               Progress& progress) {
  StageTimer timer(report, "repair");
  progress.stage("repair");
  bool any = false;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    TriangleMesh mesh = meshes[i];
    const LocalRepair repair = repairLocally(mesh, progress);
    if (!repair.succeeded || repair.changesVolume)
      continue;
    result.repairedFaces[i] = meshChanges(meshes[i], mesh).removed;
    meshes[i] = std::move(mesh);
    any = true;
  }
  return any;
}

Tetrahedralization tetsOf(std::vector<TriangleMesh>& meshes, const TetrahedralizeOptions& options,
                          TetrahedralizeResult& result, Report& report, Progress& progress) {
  try {
    progress.stage("tetrahedralize");
    return tetrahedralize(meshes, options, report, progress);
  } catch (const TooManyTets&) {
    if (!repairAll(meshes, result, report, progress))
      throw;
    progress.stage("tetrahedralize");
    return tetrahedralize(meshes, options, report, progress);
  }
}

TetrahedralizeResult runHere(const TetrahedralizeJob& job, Report& report, Progress& progress) {
  checkJob(job);
  TetrahedralizeResult result;
  std::vector<TriangleMesh> meshes = readAll(job, result, report, progress);
  progress.check();
  Preview preview;
  if (!job.preview.empty()) {
    Report told; // mixed units were reported when the files were read
    preview.input(mergeMeshes(std::vector<TriangleMesh>(meshes), told), report, progress);
  }
  cleanAll(job, meshes, result, report, progress);
  result.repairedFaces.resize(meshes.size());

  TetrahedralizeOptions options = job.mesher;
  const double diagonal = diagonalOf(boxOf(meshes));
  options.epsilon = job.epsilon.inWorld(diagonal, 0);
  options.edgeLength = job.edgeLength.inWorld(diagonal, 0);
  options.maxMemory = job.maxMemory == 0 ? availableBytes() : memoryLeft(job.maxMemory);
  Tetrahedralization made = tetsOf(meshes, options, result, report, progress);
  meshes = {};
  if (!job.preview.empty())
    preview.tets(made.mesh, report, progress);

  progress.check();
  StageTimer timer(report, "write");
  progress.stage("write");
  TetMesh mesh;
  std::replace(made.mesh.regions.begin(), made.mesh.regions.end(), -1, 0);
  result.mesh = summarize(std::move(made), mesh);
  result.regionNames = regionNames(job);
  mesh.regionNames = result.regionNames;
  if (!job.output.empty())
    writeTetMesh(job.output, mesh, progress);
  result.preview = preview.writeBeside(job.output, job.preview);
  if (!job.output.empty())
    result.output = written(job.output);
  if (job.keep)
    result.kept = std::move(mesh);
  return result;
}

} // namespace

TetrahedralizeResult run(const TetrahedralizeJob& job, Report& report, Progress& progress) {
  return inArena(job.threads, [&] { return runHere(job, report, progress); });
}

} // namespace tetvdb
