// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/RepairJob.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/formats/threemf/ThreeMfWriter.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/pipeline/CleanInput.h"
#include "tetvdb/pipeline/MeshObjects.h"
#include "tetvdb/pipeline/Preview.h"
#include "tetvdb/pipeline/RoundForFormat.h"
#include "tetvdb/surface/CloseComponents.h"
#include "tetvdb/surface/CompareSolids.h"
#include "tetvdb/surface/ExtractSurface.h"
#include "tetvdb/surface/FinestDetail.h"
#include "tetvdb/surface/TetSurface.h"
#include "tetvdb/surface/TriangleScene.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/SoupBoundary.h"
#include "tetvdb/voxelize/SoupChain.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr double kVolumeTolerance = 0.01; // relative to the solid's volume
// Limit of a remade surface, before simplification: some tens of seconds on one core.
constexpr std::size_t kMaxRepairedFaces = 4000000;
constexpr std::size_t kBytesPerFaceOfRepair = 1000; // of all stages together
constexpr double kOffFaces = 0.38;      // voxels from the box's sides to the nearest centres
constexpr std::size_t kFewestFaces = 4; // of a closed surface
constexpr std::size_t kDistanceSamples = 20000; // on each mesh
constexpr double kThickestShell = 10;           // in diagonals of the mesh's box

// The smallest voxel whose surface of a shell has at most `maxFaces` faces, three a voxel's side,
// be it as large as that of its box.
double voxelForShell(const Box& box, double shell, std::size_t maxFaces) {
  const Vec3d s = plus(minus(box.high, box.low), {shell, shell, shell});
  const double area = 2 * (s[0] * s[1] + s[1] * s[2] + s[2] * s[0]);
  return std::sqrt(3 * area / static_cast<double>(maxFaces));
}

void multiply(TriangleMesh& mesh, double factor) {
  for (Vec3d& p : mesh.points)
    p = times(p, factor);
}

// Repairs one object.
class Repair {
public:
  Repair(const RepairJob& job, Report& report, Progress& progress)
      : job_(job), report_(report), progress_(progress) {}

  RepairResult& result() { return result_; }

  TriangleMesh ofVolume(const Volume& volume) {
    result_.source = SolidSource::Volume;
    return finished(extract(volume, nullptr, nullptr));
  }

  TriangleMesh ofMesh(const TriangleMesh& given) {
    TriangleMesh mesh = given;
    clean(mesh);
    TriangleMesh surface = solidOf(std::move(mesh));
    lookAtChanges(given, surface);
    surface.units = given.units;
    return finished(std::move(surface));
  }

  // Of a cleaned mesh.
  TriangleMesh solidOf(TriangleMesh mesh) {
    TriangleMesh surface = mesh;
    if (job_.remesh || job_.solid.shell > 0 || !repairInPlace(surface)) {
      closeHoles(mesh);
      surface = remesh(mesh);
      compareVolumes(mesh, surface);
    }
    return surface;
  }

  const std::string& broken() const { return broken_; }

private:
  TriangleMesh finished(TriangleMesh surface) {
    if (job_.finish.isAsked())
      result_.finished = finishSurface(surface, job_.finish, report_, progress_);
    result_.volumeAfter = volumeOf(surface);
    convert(surface);
    result_.rounded = roundForFormat(surface, job_.output, report_, progress_);
    result_.vertices = surface.points.size();
    result_.triangles = surface.triangleCount();
    return surface;
  }

  // To the output's units.
  void convert(TriangleMesh& mesh) const {
    double factor = job_.scale;
    std::string unit;
    if (const double metres = metresOf(job_.units, &unit); metres > 0) {
      if (!mesh.units.empty() && metresOf(mesh.units) > 0)
        factor *= metresOf(mesh.units) / metres;
      mesh.units = unit;
    }
    if (factor != 1)
      multiply(mesh, factor);
  }

  // Whether `mesh` has no defects, or was repaired in place.
  bool repairInPlace(TriangleMesh& mesh) {
    {
      StageTimer timer(report_, "check");
      progress_.stage("check");
      broken_ = result_.why = whatIsBroken(mesh, progress_);
    }
    result_.remeshed = false;
    if (result_.why.empty())
      return true;
    if (job_.solid.inside == InsideRule::Winding) {
      StageTimer timer(report_, "repair");
      progress_.stage("repair");
      result_.local = repairLocally(mesh, progress_);
      if (result_.local->succeeded) {
        result_.why.clear();
        if (const SheetCounts& sheets = result_.local->sheets; sheets.faces > 0)
          report_.warn("sheets",
                       fmt::format("{} faces in {} open components bound no volume and are left "
                                   "out; `shell` gives sheets a thickness",
                                   sheets.faces, sheets.parts));
        if (const SolidComparison& solids = result_.local->solids; result_.local->changesVolume)
          report_.warn(
              "volume-changed",
              fmt::format(
                  "of a solid of {:.4g}, where it is well defined, repair in place "
                  "lost {:.2g} and added {:.2g}{}",
                  solids.before, solids.lost, solids.gained,
                  result_.local->closingChangesVolume
                      ? ", by filling holes and leaving out sheets; `remesh` of repair makes the "
                        "surface where the winding number is 0.5"
                      : ""));
        report_.partial = report_.partial || result_.local->closingChangesVolume;
        return true;
      }
      result_.why = result_.local->why;
    }
    return false;
  }

  TriangleMesh remesh(const TriangleMesh& mesh) {
    result_.remeshed = true;
    const Volume volume = voxelizeMesh(mesh);
    const TriangleScene scene(mesh);
    const std::optional<BoundaryWinding> boundary = boundaryOf(mesh);
    TriangleMesh surface = extract(volume, &scene, boundary ? &*boundary : nullptr);
    surface.units = mesh.units;
    if (!result_.why.empty())
      report_.warn("remeshed",
                   fmt::format("the surface was remade from voxels of {:.6g}, since repair in "
                               "place failed ({}); details finer than that are lost",
                               result_.transform.voxelSize[0], result_.why));
    return surface;
  }

  void closeHoles(TriangleMesh& mesh) {
    if (!job_.solid.closesHoles())
      return;
    const ClosedComponents closed = closeComponents(mesh, progress_);
    result_.cleaned.closedHoles = closed.holes.size();
    result_.cleaned.closingFaces = closed.faces;
  }

  // Compares a mesh and the surface remade from voxels.
  void compareVolumes(const TriangleMesh& before, const TriangleMesh& after) {
    if (job_.solid.shell > 0 || job_.solid.inside != InsideRule::Winding)
      return;
    StageTimer timer(report_, "compare");
    progress_.stage("compare");
    const SolidComparison solids = compareSolids(before, after, progress_);
    if (std::abs(solids.after - solids.before) <= kVolumeTolerance * solids.before)
      return;
    report_.warn("volume-changed",
                 fmt::format("the solid had a volume of {:.4g} and has {:.4g}: parts of it are "
                             "thinner than a voxel; use a finer `resolution` of repair",
                             solids.before, solids.after));
    report_.partial = true;
  }

  void lookAtChanges(const TriangleMesh& before, const TriangleMesh& after) {
    StageTimer timer(report_, "compare");
    progress_.stage("compare");
    result_.changes = meshChanges(before, after);
    if (result_.changes->added + result_.changes->removed == 0)
      return;
    MeshDistanceOptions options;
    options.samples = kDistanceSamples;
    result_.distance = compareMeshes(before, after, options, progress_);
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
    requireShapedShell(mesh);
  }

  // A thicker shell is a ball, whatever the mesh.
  void requireShapedShell(const TriangleMesh& mesh) const {
    const Box box = boxOf(mesh.points, mesh.triangles);
    const double diagonal = length(minus(box.high, box.low));
    if (job_.solid.shell > kThickestShell * diagonal)
      throw Error(
          Status::Usage, "`shell`",
          fmt::format("a thickness of {:.6g} is more than {} times the mesh's diagonal, {:.6g}",
                      job_.solid.shell, kThickestShell, diagonal),
          "give it in the mesh's units");
  }

  Volume voxelizeMesh(const TriangleMesh& mesh) {
    VoxelizeOptions options;
    options.grids = {GridKind::Mask};
    options.voxelSize = job_.voxelSize;
    options.resolution = job_.resolution;
    options.maxMemory = memoryLeft(job_.maxMemory);
    progress_.stage("voxelize");
    if (job_.resolution == 0 && job_.voxelSize == Vec3d{0, 0, 0}) {
      const std::size_t memory = options.maxMemory > 0 ? options.maxMemory : availableBytes();
      const std::size_t maxFaces = std::min(kMaxRepairedFaces, memory / kBytesPerFaceOfRepair);
      double size = voxelForDetail(mesh, maxFaces, progress_);
      if (job_.solid.shell > 0)
        size = std::max(
            size, voxelForShell(boxOf(mesh.points, mesh.triangles), job_.solid.shell, maxFaces));
      options.voxelSize.fill(size);
    }
    options.origin = originOffFaces(mesh, options);
    Voxelization made = voxelize(mesh, job_.solid, options, report_, progress_);
    result_.transform = made.transform;
    return std::move(made.volume);
  }

  // The sides of the box then pass between the voxels' centres, and with them most flat sides.
  Vec3d originOffFaces(const TriangleMesh& mesh, const VoxelizeOptions& options) const {
    const Vec3d size = chooseTransform(mesh, options, job_.solid).voxelSize;
    return minus(boxOf(mesh.points, mesh.triangles).low, times(size, kOffFaces));
  }

  // On the lattice of the voxels, if the winding number closes holes.
  std::optional<BoundaryWinding> boundaryOf(const TriangleMesh& mesh) const {
    if (!job_.solid.closesHoles())
      return std::nullopt;
    const SoupBoundary boundary = soupBoundary(mesh, progress_);
    if (boundary.edges.empty())
      return std::nullopt;
    return boundaryWinding(boundary.edges, snapPoints(mesh.points, result_.transform, progress_));
  }

  TriangleMesh extract(const Volume& volume, const TriangleScene* scene,
                       const BoundaryWinding* boundary) {
    StageTimer timer(report_, "extract");
    progress_.stage("extract");
    ExtractOptions options;
    options.grid = job_.grid;
    options.original = scene;
    options.boundary = boundary;
    options.distance = job_.solid.shell / 2;
    options.maxMemory = memoryLeft(job_.maxMemory);
    options.simplify = job_.simplify;
    return extractSurface(volume, options, progress_, &result_.extracted);
  }

  const RepairJob& job_;
  Report& report_;
  Progress& progress_;
  RepairResult result_;
  std::string broken_; // what the cleaned mesh had
};

// Combines the results of two objects.
void addTo(RepairResult& sum, const RepairResult& object) {
  sum.remeshed = sum.remeshed || object.remeshed;
  sum.extracted += object.extracted;
  sum.vertices += object.vertices;
  sum.triangles += object.triangles;
  sum.volumeBefore += object.volumeBefore;
  sum.volumeAfter += object.volumeAfter;
  if (object.changes) {
    MeshChanges& changes = sum.changes ? *sum.changes : sum.changes.emplace();
    changes.kept += object.changes->kept;
    changes.added += object.changes->added;
    changes.removed += object.changes->removed;
  }
  if (object.distance) {
    MeshDistance& distance = sum.distance ? *sum.distance : sum.distance.emplace();
    distance.aToB.largest = std::max(distance.aToB.largest, object.distance->aToB.largest);
    distance.bToA.largest = std::max(distance.bToA.largest, object.distance->bToA.largest);
    distance.hausdorff = std::max(distance.hausdorff, object.distance->hausdorff);
  }
}

// Repairs the objects of files and writes them to one file.
class RepairFiles {
public:
  RepairFiles(const RepairJob& job, Report& report, Progress& progress)
      : job_(job), report_(report), progress_(progress), inputs_(job.more) {
    inputs_.insert(inputs_.begin(), job.input);
  }

  RepairResult run() {
    if (job_.solid.side != ShellSide::Both)
      throw Error(Status::Usage, "", "a repaired shell lies on both sides of the faces",
                  "voxelize it with `shell_side`, and repair the volume");
    if (!job_.output.empty() || !job_.keep) {
      requireFormat(job_.output, {FormatUse::WriteTriangles});
      requireWritable(job_.output);
    }
    checkPreviewPath(job_.preview);
    requireSeparateFiles(filesAmong(inputs_, job_.memory), {job_.output, job_.preview});
    if (!job_.units.empty() && !(metresOf(job_.units) > 0))
      throw Error(Status::Usage, "units", "'" + job_.units + "' is not a known unit",
                  "choose from um, mm, cm, m, in and ft");
    if (!std::isfinite(job_.scale) || !(job_.scale > 0))
      throw Error(Status::Usage, "scale", "must be a number above zero");
    std::vector<NamedMesh> objects = job_.isVolume ? fromVolume() : fromMeshes();
    if (!job_.preview.empty())
      preview_.surface(objects.size() == 1 ? objects.front().mesh : joinObjects(objects),
                       "repaired", report_, progress_);
    write(objects);
    return std::move(result_);
  }

private:
  std::vector<NamedMesh> fromVolume() {
    Volume volume;
    {
      StageTimer timer(report_, "read");
      progress_.stage("read");
      volume = readVolumeInput(job_.input, report_, progress_, job_.memory);
    }
    if (!job_.preview.empty())
      preview_.volume(volume, report_, progress_);
    Repair repair(job_, report_, progress_);
    NamedMesh object;
    object.mesh = repair.ofVolume(volume);
    result_ = std::move(repair.result());
    return {std::move(object)};
  }

  std::vector<NamedMesh> fromMeshes() {
    std::vector<NamedMesh> objects = read();
    if (objects.size() > 1 && !keepsObjects(job_.output)) {
      report_.warn("objects-joined",
                   fmt::format("the {} objects of the input are repaired as one: the output's "
                               "format has no objects; .3mf keeps them separate",
                               objects.size()));
      NamedMesh all;
      all.mesh = joinObjects(objects);
      objects.clear();
      objects.push_back(std::move(all));
    }
    if (!job_.preview.empty())
      preview_.input(objects.size() == 1 ? objects.front().mesh : joinObjects(objects), report_,
                     progress_);
    if (objects.size() == 1) {
      const SolidSource source = result_.source;
      const InputInfo input = result_.input;
      NamedMesh& object = objects.front();
      Repair repair(job_, report_, progress_);
      object.mesh = repair.ofMesh(object.mesh);
      result_ = std::move(repair.result());
      result_.source = source;
      result_.input = input;
      result_.name = object.name;
      return objects;
    }
    repairEach(objects);
    return objects;
  }

  void repairEach(std::vector<NamedMesh>& objects) {
    std::size_t faces = 0;
    for (const NamedMesh& object : objects)
      faces += object.mesh.triangleCount();
    result_.remeshed = false;
    for (NamedMesh& object : objects) {
      RepairJob job = job_;
      if (job.finish.faces > 0)
        job.finish.faces = std::max<std::size_t>(
            kFewestFaces, job.finish.faces * object.mesh.triangleCount() / faces);
      const std::size_t warningsBefore = report_.warnings.size();
      const std::string name = "object '" + object.name + "'";
      Repair repair(job, report_, progress_);
      try {
        object.mesh = repair.ofMesh(object.mesh);
      } catch (const Error& error) {
        if (error.status() == Status::Cancelled)
          throw;
        throw Error(error.status(), name, error.what());
      }
      for (std::size_t i = warningsBefore; i < report_.warnings.size(); ++i)
        report_.warnings[i].text = name + ": " + report_.warnings[i].text;
      repair.result().name = object.name;
      addTo(result_, repair.result());
      result_.objects.push_back(std::move(repair.result()));
    }
  }

  std::vector<NamedMesh> read() {
    StageTimer timer(report_, "read");
    progress_.stage("read");
    std::vector<NamedMesh> objects;
    for (const std::string& path : inputs_) {
      if (!holdsTriangles(path, job_.memory)) {
        if (inputs_.size() > 1)
          throw Error(Status::Usage, path, "has no triangles, which several inputs require",
                      "repair it by itself");
        return {tetsOf(path, timer)};
      }
      InputInfo info;
      const std::size_t first = objects.empty() ? 0 : objects.back().assembly + 1;
      for (NamedMesh& object : readObjects(path, first, &info, report_, progress_, job_.memory))
        objects.push_back(std::move(object));
      if (result_.input.path.empty()) {
        result_.input = info;
      } else {
        result_.input.vertices += info.vertices;
        result_.input.triangles += info.triangles;
      }
    }
    requireOneUnit(objects);
    return objects;
  }

  NamedMesh tetsOf(const std::string& path, StageTimer& timer) {
    result_.source = SolidSource::Tets;
    ReadOptions options;
    options.attributes = false;
    const TetMesh tets =
        readTets(path, options, {}, &result_.input, report_, progress_, job_.memory);
    timer.part("surface");
    NamedMesh object;
    object.mesh = tetSurface(tets, progress_);
    return object;
  }

  // A file has one unit: objects with others are converted to that of the first object with a unit.
  static void requireOneUnit(std::vector<NamedMesh>& objects) {
    std::string unit;
    for (const NamedMesh& object : objects)
      if (unit.empty())
        unit = object.mesh.units;
    for (NamedMesh& object : objects)
      if (object.mesh.units != unit) {
        if (!object.mesh.units.empty())
          multiply(object.mesh, metresOf(object.mesh.units) / metresOf(unit));
        object.mesh.units = unit;
      }
  }

  void write(const std::vector<NamedMesh>& objects) {
    StageTimer timer(report_, "write");
    progress_.stage("write");
    result_.units = objects.front().mesh.units;
    if (job_.keep)
      result_.kept = objects.size() == 1 ? objects.front().mesh : joinObjects(objects);
    if (job_.output.empty()) {
      result_.preview = preview_.writeBeside(job_.output, job_.preview);
      return;
    }
    if (keepsObjects(job_.output)) {
      if (result_.units.empty()) {
        const std::string likely = result_.before ? result_.before->likelyUnit : std::string();
        report_.warn("unit-guessed",
                     "the input has no unit, which 3MF requires: millimetres are written" +
                         (likely.empty() || likely == "millimetres"
                              ? std::string()
                              : ", although the size suggests " + likely) +
                         "; `units` sets it");
      }
      writeThreeMf(job_.output, objects, progress_);
    } else {
      writeTriangles(job_.output, objects.front().mesh, progress_);
    }
    result_.preview = preview_.writeBeside(job_.output, job_.preview);
    result_.output = written(job_.output);
  }

  const RepairJob& job_;
  Report& report_;
  Progress& progress_;
  std::vector<std::string> inputs_;
  Preview preview_;
  RepairResult result_;
};

} // namespace

const char* nameOf(SolidSource source) {
  constexpr const char* kNames[] = {"triangles", "tets", "volume"};
  return kNames[static_cast<std::size_t>(source)];
}

RepairResult run(const RepairJob& job, Report& report, Progress& progress) {
  return inArena(job.threads, [&] { return RepairFiles(job, report, progress).run(); });
}

MendedSolid mendSolid(TriangleMesh& mesh, const std::string& name, std::size_t maxMemory,
                      Report& report, Progress& progress) {
  RepairJob job;
  job.input = name;
  job.maxMemory = maxMemory;
  Repair repair(job, report, progress);
  try {
    mesh = repair.solidOf(std::move(mesh));
  } catch (const Error& error) {
    if (error.status() != Status::Invalid)
      throw;
    throw Error(Status::Invalid, name, "has " + repair.broken() + " and encloses nothing",
                "give sheets a thickness with `shell=T` of repair");
  }
  return {repair.broken(), repair.result().remeshed};
}

} // namespace tetvdb
