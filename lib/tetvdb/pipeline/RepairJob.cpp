// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/RepairJob.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/surface/ExtractSurface.h"
#include "tetvdb/surface/FloatPositions.h"
#include "tetvdb/surface/TetSurface.h"
#include "tetvdb/surface/TriangleScene.h"

#include <tbb/task_arena.h>
#include <utility>

namespace tetvdb {
namespace {

// Divergence theorem, about the first point.
double volumeOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const Vec3d& origin = mesh.points[mesh.triangles[0]];
    sum += dot(minus(mesh.points[mesh.triangles[i]], origin),
               cross(minus(mesh.points[mesh.triangles[i + 1]], origin),
                     minus(mesh.points[mesh.triangles[i + 2]], origin)));
  }
  return sum / 6;
}

class Repair {
public:
  Repair(const RepairJob& job, Report& report, Progress& progress)
      : job_(job), report_(report), progress_(progress) {}

  RepairResult run() {
    requireExtension(job_.output, {".stl", ".obj", ".ply", ".off", ".3mf"},
                     "name it .stl, .obj, .ply, .off or .3mf");
    requireNoInput(job_.output, {job_.input});
    requireWritable(job_.output);
    checkPreviewPath(job_.preview, {job_.input});
    TriangleMesh surface = job_.isVolume ? fromVolume() : fromMesh();
    result_.vertices = surface.points.size();
    result_.triangles = surface.triangleCount();
    result_.volumeAfter = volumeOf(surface);
    if (!job_.preview.empty())
      preview_.surface(surface, "repaired", report_, progress_);
    StageTimer timer(report_, "write");
    progress_.stage("write");
    writeTriangles(job_.output, surface, progress_);
    result_.preview = preview_.writeBeside(job_.output, job_.preview);
    result_.output = written(job_.output);
    return std::move(result_);
  }

private:
  TriangleMesh fromVolume() {
    result_.source = SolidSource::Volume;
    Volume volume;
    {
      StageTimer timer(report_, "read");
      progress_.stage("read");
      volume = readVolume(job_.input, progress_);
    }
    if (!job_.preview.empty())
      preview_.volume(volume, report_, progress_);
    return extract(volume, nullptr);
  }

  TriangleMesh fromMesh() {
    TriangleMesh mesh = read();
    if (!job_.preview.empty())
      preview_.input(mesh, report_, progress_);
    clean(mesh);
    if (!job_.remesh && job_.solid.shell == 0 && isInOrder(mesh)) {
      result_.remeshed = false;
      return mesh;
    }
    const Volume volume = voxelizeMesh(mesh);
    const std::string units = mesh.units;
    TriangleMesh surface;
    {
      const TriangleScene scene(mesh);
      surface = extract(volume, &scene);
    }
    surface.units = units;
    return surface;
  }

  TriangleMesh read() {
    StageTimer timer(report_, "read");
    progress_.stage("read");
    if (holdsTriangles(job_.input))
      return readSoup(job_.input, &result_.input, report_, progress_);
    result_.source = SolidSource::Tets;
    ReadOptions options;
    options.attributes = false;
    const TetMesh tets = readTets(job_.input, options, {}, &result_.input, report_, progress_);
    timer.part("surface");
    return tetSurface(tets, progress_);
  }

  void clean(TriangleMesh& mesh) {
    StageTimer timer(report_, "clean");
    timer.part("look");
    progress_.stage("look");
    result_.before = surfaceDefects(mesh, {}, progress_);
    timer.part("clean");
    progress_.stage("clean");
    result_.cleaned = cleanTriangles(mesh, job_.clean, progress_);
    if (mesh.triangles.empty())
      throw Error(Status::Invalid, job_.input,
                  "every face of the mesh is degenerate or one of a pair that cancels out");
    result_.volumeBefore = volumeOf(mesh);
  }

  bool isInOrder(const TriangleMesh& mesh) {
    StageTimer timer(report_, "check");
    progress_.stage("check");
    DefectOptions options;
    options.windingSamples = 0;
    options.maxIntersections = 0;
    SurfaceDefects defects = surfaceDefects(mesh, options, progress_);
    if (defects.boundaryEdges + defects.nonManifoldEdges + defects.misorientedEdges +
            defects.nonManifoldVertices + defects.duplicateFaces + defects.degenerateFaces >
        0)
      return false;
    if (!(defects.volume > 0) || !equalAsFloats(mesh.points).empty())
      return false;
    options.maxIntersections = 1;
    return surfaceDefects(mesh, options, progress_).selfIntersections == 0;
  }

  Volume voxelizeMesh(const TriangleMesh& mesh) {
    VoxelizeOptions options;
    options.grids = {GridKind::Mask};
    options.voxelSize = job_.voxelSize;
    options.resolution = job_.resolution;
    options.maxMemory = memoryLeft(job_.maxMemory);
    progress_.stage("voxelize");
    Voxelization made = voxelize(mesh, job_.solid, options, report_, progress_);
    result_.transform = made.transform;
    return std::move(made.volume);
  }

  TriangleMesh extract(const Volume& volume, const TriangleScene* scene) {
    StageTimer timer(report_, "extract");
    progress_.stage("extract");
    ExtractOptions options;
    options.grid = job_.grid;
    options.original = scene;
    options.distance = job_.solid.shell / 2;
    options.maxMemory = memoryLeft(job_.maxMemory);
    options.simplify = job_.simplify;
    return extractSurface(volume, options, progress_, &result_.extracted);
  }

  const RepairJob& job_;
  Report& report_;
  Progress& progress_;
  Preview preview_;
  RepairResult result_;
};

} // namespace

RepairResult run(const RepairJob& job, Report& report, Progress& progress) {
  if (job.threads <= 0)
    return Repair(job, report, progress).run();
  tbb::task_arena arena(job.threads);
  return arena.execute([&] { return Repair(job, report, progress).run(); });
}

} // namespace tetvdb
