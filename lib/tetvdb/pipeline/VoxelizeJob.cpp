// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/VoxelizeJob.h"

#include "tetvdb/core/ClosestName.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/fields/NeededArrays.h"
#include "tetvdb/fields/SampleOnDevice.h"
#include "tetvdb/fields/ShapesOnDevice.h"
#include "tetvdb/fields/SmoothCells.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/io/TileFiles.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/io/volume/NanoFile.h"
#include "tetvdb/io/volume/PackedGrid.h"
#include "tetvdb/pipeline/ArrayOutput.h"
#include "tetvdb/pipeline/ChooseMesher.h"
#include "tetvdb/pipeline/CleanInput.h"
#include "tetvdb/pipeline/DeviceGrids.h"
#include "tetvdb/pipeline/FitVolume.h"
#include "tetvdb/pipeline/MergeMeshes.h"
#include "tetvdb/pipeline/MeshWithinLimits.h"
#include "tetvdb/pipeline/OriginMetadata.h"
#include "tetvdb/pipeline/PrepareMesh.h"
#include "tetvdb/pipeline/Preview.h"
#include "tetvdb/pipeline/StreamJob.h"
#include "tetvdb/pipeline/StreamOptions.h"
#include "tetvdb/pipeline/VoxelizeOutput.h"
#include "tetvdb/pipeline/prepared/PreparedJob.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/NanoGrids.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/SoupBoundary.h"
#include "tetvdb/voxelize/VoxelizeMaterials.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <utility>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

// Which of the job's grids voxelize() makes.
std::vector<GridKind> voxelizedOf(const VoxelizeJob& job) {
  return madeBy(job.grids, {GridMaker::Occupancy, GridMaker::Owner});
}

// Before the work starts; arrays of the mesh are looked at when they are known.
void checkLevelsOf(const VoxelizeJob& job) {
  if (job.levels.isEmpty())
    return;
  checkLevels(job.levels);
  for (const GridKind kind : job.grids)
    requireLevels(std::string(infoOf(kind).name), infoOf(kind).type, infoOf(kind).gridClass);
  if (isArrayFile(job.output))
    throw Error(Status::Usage, "`lod`", "is for .vdb and .nvdb files", "leave it out");
}

void checkOutputs(const VoxelizeJob& job) {
  const ShapeOptions shapes = shapesOf(job);
  checkShapes(shapes, job.voxelize.voxelSize);
  if (job.voxelize.rule != VoxelRule::Centre && !shapes.grids.empty())
    throw Error(Status::Usage, "`rule`",
                "is for density and mask; surface, fog and coverage know of no rule",
                "make them without it");
  if (job.inputs.empty())
    throw Error(Status::Usage, "", "no input was given");
  if (!job.makesVolume() && job.meshOutput.empty())
    throw Error(Status::Usage, "", "no output was given", "name one by `output`");
  std::vector<std::string> outputs;
  if (!job.output.empty()) {
    if (job.tileSize > 0) {
      requireTileFolder(job.output, job.tileSize, job.levels, job.inputs);
      if (!job.shard.isWhole() || job.plan > 0)
        throw Error(Status::Usage, "`tiles`", "are of whole volumes, not of shards",
                    "cut the merged volume into tiles");
    } else {
      requireFormat(job.output, {FormatUse::WriteVolume, FormatUse::WriteArrays});
      checkArrayOutput(job);
      if (writesNvdb(job) && job.maskType == MaskType::Mask && contains(job.grids, GridKind::Mask))
        throw Error(Status::Usage, "`mask_type`",
                    "is for .vdb files: a MaskGrid has no NanoVDB form here",
                    "leave it out: the mask becomes a grid of bool");
      outputs = arrayFiles(job.output);
      for (const std::string& path : outputs)
        requireWritable(path);
    }
  }
  checkPreviewPath(job.preview);
  if (!job.meshOutput.empty()) {
    requireFormat(job.meshOutput, {FormatUse::WriteTets, FormatUse::WriteTriangles});
    requireWritable(job.meshOutput);
  }
  checkLevelsOf(job);
  outputs.insert(outputs.end(), {job.meshOutput, job.preview});
  requireSeparateFiles(filesAmong(job.inputs, job.memory), outputs);
}

// Of triangles, which have no arrays.
void refuseArrays(const VoxelizeJob& job) {
  if (!job.warp.array.empty())
    throw Error(Status::Usage, "`warp`", "takes an array of a solid mesh; the input is triangles",
                "leave it out");
  if (job.smooth)
    throw Error(Status::Usage, "`smooth`", "is for arrays over cells; the input is triangles",
                "leave it out");
  if (job.fields.empty())
    return;
  const std::string name = job.fields.all ? "all" : job.fields.requests.front().array;
  throw Error(Status::Usage, "`grid`",
              "'" + name + "' is an array of a solid mesh; the input is triangles",
              suggestName(name, gridKindNames(), "choose from " + listGridKinds()));
}

// Whether the inputs hold triangles; one job takes one kind.
bool inputsHoldTriangles(const VoxelizeJob& job) {
  const bool first = holdsTriangles(job.inputs.front(), job.memory);
  for (const std::string& input : job.inputs)
    if (holdsTriangles(input, job.memory) != first)
      throw Error(Status::Usage, input,
                  fmt::format("holds {}, but {} holds {}", first ? "tetrahedra" : "triangles",
                              job.inputs.front(), first ? "triangles" : "tetrahedra"),
                  "voxelize them one by one");
  const CellFilter& filter = job.filter;
  const CellFilter none;
  if (first && !(filter.regions.empty() && filter.exclude.empty() && filter.boxMin == none.boxMin &&
                 filter.boxMax == none.boxMax))
    throw Error(Status::Usage, "`region`, `exclude`, `bbox`",
                "choose cells of a solid mesh; the input is triangles", "leave them out");
  if (first)
    refuseArrays(job);
  if (!job.meshOutput.empty() && !first && writesTriangles(job.meshOutput))
    throw Error(Status::Usage, job.meshOutput, "cannot hold tetrahedra",
                "name it " + endingList(FormatUse::WriteTets));
  return first;
}

// Which step of several was taken where none was asked for.
void warnOfOtherSteps(const InputInfo& info, const ReadOptions& wanted, Report& report) {
  if (info.times.size() < 2 || wanted.timeStep >= 0)
    return;
  report.warn("last-step", fmt::format("{}: has {} time steps; the last one, at {:.6g}, is taken; "
                                       "`frames` takes others, each as a frame",
                                       info.path, info.times.size(), info.times[info.step]));
}

// Reads every input by read(path, info).
template <typename Mesh, typename Read>
std::vector<Mesh> readAll(const VoxelizeJob& job, VoxelizeResult& result, Report& report,
                          Progress& progress, const Read& read) {
  StageTimer timer(report, "read");
  progress.stage("read");
  std::vector<Mesh> meshes;
  for (const std::string& input : job.inputs) {
    InputInfo info;
    timer.part(input);
    meshes.push_back(read(input, info));
    turnUp(meshes.back().points, job.up);
    result.tets += info.tets;
    result.volume += info.statistics.volume;
    result.inputs.push_back(std::move(info));
  }
  return meshes;
}

// `nano`: the grids in place of the volume's, once voxelizeMesh() has run; `packed`: grids that
// come after the volume's.
template <typename Voxelize>
Volume makeVolume(const VoxelizeJob& job, const std::vector<NanoBytes>& nano,
                  const PackedGrids& packed, VoxelizeResult& result, Report& report,
                  Progress& progress, const Voxelize& voxelizeMesh) {
  VoxelizeOptions options = job.voxelize;
  options.grids = voxelizedOf(job);
  options.maxMemory = memoryLeft(job.maxMemory);
  Voxelization made = voxelizeMesh(options);
  result.counts = made.counts;
  result.transform = made.transform;
  for (const NanoBytes& grid : nano)
    result.grids.push_back(describeNano(grid.data.get(), grid.insideVoxels));
  if (!nano.empty()) {
    checkValues(job, result.grids, report);
    return {};
  }
  setMaskType(job, made.volume.grids().all);
  made.volume.metadata = originMetadata(job);
  setHalf(job, made.volume.grids().all);
  fitVolume(made.volume, made.transform, job.voxelize.fit, report);
  for (const auto& grid : made.volume.grids().all)
    openFirstTile(*grid);
  result.grids = describe(made.volume);
  for (const auto& one : packed) {
    openFirstTile(*one->grid);
    result.grids.push_back(describe(*one));
  }
  checkValues(job, result.grids, report);
  if (!job.levels.isEmpty() && job.tileSize == 0) // tiles get theirs when they are cut
    for (GridInfo& info :
         addDescribedLevels(made.volume, job.levels, memoryLeft(job.maxMemory), progress))
      result.grids.push_back(std::move(info));
  return std::move(made.volume);
}

// The grids of `voxelizeMesh` and then those of shapesOf(job), which `addShapes` makes with the
// mask, or `makeOnDevice` on the device that has made the others, which are in `nano` then. A thin
// mesh can fill parts of voxels, and none of their centres.
template <typename Voxelize, typename AddShapes, typename MakeOnDevice>
Voxelization withShapes(const VoxelizeJob& job, VoxelizeOptions options,
                        const Voxelize& voxelizeMesh, const AddShapes& addShapes,
                        const MakeOnDevice& makeOnDevice, std::vector<NanoBytes>* nano) {
  ShapeOptions shapes = shapesOf(job);
  if (shapes.grids.empty())
    return voxelizeMesh(options);
  const auto asked = static_cast<std::ptrdiff_t>(options.grids.size());
  const bool hasMask = contains(options.grids, GridKind::Mask);
  const bool coverageOnly = job.grids == std::vector<GridKind>{GridKind::Coverage};
  options.allowEmpty = options.allowEmpty || coverageOnly;
  if (!hasMask)
    options.grids.push_back(GridKind::Mask);
  Voxelization made = voxelizeMesh(options);
  shapes.maxMemory = memoryLeft(job.maxMemory);
  shapes.device = job.device;
  if (const int side = job.voxelize.fit.voxels; side > 0)
    shapes.box = VoxelBox{{0, 0, 0}, {side - 1, side - 1, side - 1}};
  if (nano != nullptr && !nano->empty() &&
      addDeviceShapes(
          *nano, hasMask, [&] { return makeOnDevice(shapes, made.transform); }, made))
    return made;
  addShapes(shapes, made);
  openvdb::GridPtrVec& grids = made.volume.grids().all;
  if (!hasMask)
    grids.erase(grids.begin() + asked);
  if (coverageOnly)
    requireVoxels(made, job.voxelize);
  return made;
}

// The grids that are named, those of the shape, then those of arrays, one transform. The last are
// packed on their way into a .vdb file.
Voxelization voxelizeTets(const VoxelizeJob& job, const TetMesh& mesh,
                          const VoxelizeOptions& options, std::vector<NanoBytes>* nano,
                          PackedGrids& packed, VoxelizeResult& result, Report& report,
                          Progress& progress) {
  std::vector<Field> fields;
  if (!job.fields.empty()) {
    FieldOptions wanted = job.fields;
    wanted.turnVectors = job.up == UpAxis::Y;
    fields =
        resolveFields(mesh, wanted, report, job.fieldRanges.empty() ? nullptr : &job.fieldRanges);
  }
  if (isArrayFile(job.output))
    requireArrayRoom(job, boxOfUsed(mesh.points, mesh.tets), chooseTransform(mesh, options));
  Voxelization made;
  const bool fieldsAlone = !fields.empty() && job.grids.empty();
  if (fieldsAlone) {
    made.transform = chooseTransform(mesh, options);
    reportTransform(made.transform, options, report);
  } else {
    made = withShapes(
        job, options,
        [&](const VoxelizeOptions& more) {
          return voxelize(mesh, more, job.device, result.device, nano, report, progress);
        },
        [&](const ShapeOptions& shapes, Voxelization& sofar) {
          result.shapes = addShapeGrids(mesh, shapes, sofar, report, progress);
        },
        [&](const ShapeOptions& shapes, const GridTransform& transform) {
          return shapesOnDevice(mesh, transform, shapes, result.shapes, report, progress);
        },
        nano);
  }
  if (fields.empty())
    return made;
  SampleOptions sampling;
  sampling.maxMemory = memoryLeft(job.maxMemory);
  sampling.allowEmpty = options.allowEmpty;
  PackOptions pack;
  pack.folder = fs::path(job.output).parent_path().string();
  pack.half = job.half;
  const bool asNano =
      nano != nullptr && (fieldsAlone || !nano->empty()) && makesNanoGrids(mesh, fields);
  if (nano != nullptr && !asNano)
    makeTrees(*nano, made);
  const SnapCounts counts =
      asNano
          ? addFields(*nano, mesh, fields, sampling, job.device, result.fieldsDevice, made, report,
                      progress)
          : sampleFields(mesh, made.transform, fields, sampling, packsArrays(job) ? &pack : nullptr,
                         job.device, result.fieldsDevice, packed, made.volume, report, progress);
  if (fieldsAlone) {
    made.counts = counts;
    result.device = result.fieldsDevice;
    reportTets(counts, mesh.tetCount(), report);
  }
  return made;
}

void runTets(const VoxelizeJob& job, VoxelizeResult& result, Report& report, Progress& progress) {
  ReadOptions wanted = job.read;
  if (wanted.arrays.empty() && job.meshOutput.empty())
    wanted.arrays = neededArrays(job.fields, job.warp);
  const auto read = [&](const std::string& path, InputInfo& info) {
    TetMesh one = readTets(path, wanted, job.filter, &info, report, progress, job.memory);
    warnOfOtherSteps(info, wanted, report);
    warpPoints(one, job.warp);
    if (job.smooth)
      smoothCells(one);
    return one;
  };
  TetMesh mesh = mergeMeshes(readAll<TetMesh>(job, result, report, progress, read), report);
  progress.check();
  Preview preview(job.up == UpAxis::Y);
  if (!job.preview.empty())
    preview.tets(mesh, report, progress);
  if (job.makesVolume() && streamTets(job, mesh, result, report, progress))
    return;
  Volume volume;
  std::vector<NanoBytes> nano;
  PackedGrids packed;
  if (job.makesVolume()) {
    volume = makeVolume(job, nano, packed, result, report, progress,
                        [&](const VoxelizeOptions& options) {
                          return voxelizeTets(job, mesh, options, nanoPlace(job, nano), packed,
                                              result, report, progress);
                        });
    if (job.meshOutput.empty())
      mesh = TetMesh(); // its memory serves the writer
    if (!job.preview.empty())
      preview.volume(volume, report, progress);
  }
  progress.check();
  writeOutputs(
      job, {volume, nano, packed, preview}, [&] { writeTetMesh(job.meshOutput, mesh, progress); },
      result, report, progress);
}

void add(CleanCounts& sum, const CleanCounts& more) {
  sum.weldedPoints += more.weldedPoints;
  sum.unreferencedPoints += more.unreferencedPoints;
  sum.degenerateFaces += more.degenerateFaces;
  sum.duplicateFaces += more.duplicateFaces;
  sum.innerFaces += more.innerFaces;
  sum.flippedFaces += more.flippedFaces;
  sum.flippedParts += more.flippedParts;
  sum.closedHoles += more.closedHoles;
  sum.closingFaces += more.closingFaces;
  sum.insideOut = sum.insideOut || more.insideOut;
  sum.weldDistance = std::max(sum.weldDistance, more.weldDistance);
  sum.doubtful = sum.doubtful || more.doubtful;
}

// From triangles to a volume, to tets, or to both.
class TriangleRun {
public:
  TriangleRun(const VoxelizeJob& job, VoxelizeResult& result, Report& report, Progress& progress)
      : job_(job), result_(result), report_(report), progress_(progress),
        preview_(job.up == UpAxis::Y) {}

  void run() {
    checkMesher(job_);
    read();
    progress_.check();
    if (!job_.preview.empty()) {
      Report told; // of mixed units, when the files were read
      preview_.input(mergeMeshes(std::vector<TriangleMesh>(meshes_), told), report_, progress_);
    }
    clean();
    if (job_.makesVolume() || needsTets(job_))
      chooseMethod();
    if (!job_.shard.isWhole() || job_.plan > 0)
      requireShards();
    if (job_.makesVolume() && !byTets() &&
        streamTriangles(job_, meshes_, unitsFound(), result_, report_, progress_))
      return;
    Volume volume;
    if (job_.makesVolume()) {
      volume = makeVolume(job_, nano_, {}, result_, report_, progress_,
                          [&](const VoxelizeOptions& options) { return makeGrids(options); });
      for (const auto& [key, text] : unitsFound())
        volume.metadata.emplace(key, text);
    }
    if (!job_.preview.empty() && job_.makesVolume())
      preview_.volume(volume, report_, progress_);
    progress_.check();
    writeOutputs(
        job_, {volume, nano_, {}, preview_}, [&] { writeMesh(); }, result_, report_, progress_);
  }

private:
  void read() {
    meshes_ = readAll<TriangleMesh>(job_, result_, report_, progress_,
                                    [&](const std::string& path, InputInfo& info) {
                                      return readSoup(path, &info, report_, progress_, job_.memory);
                                    });
    if (!asMaterials()) {
      TriangleMesh all = mergeMeshes(std::move(meshes_), report_);
      meshes_.clear();
      meshes_.push_back(std::move(all));
      units_ = meshes_.front().units;
    } else if (haveOneUnit(meshes_, report_)) {
      units_ = meshes_.front().units;
    }
  }

  void clean() {
    StageTimer timer(report_, "clean");
    progress_.stage("clean");
    for (std::size_t i = 0; i < meshes_.size(); ++i) {
      const std::string name = meshes_.size() == 1 ? "" : job_.inputs[i];
      add(result_.cleaned,
          cleanInput(meshes_[i], name, cleaningFor(job_.solid, job_.clean), report_, progress_));
      result_.triangles += meshes_[i].triangleCount();
    }
  }

  void chooseMethod() {
    const WorldBox box = boxOf(meshes_);
    transform_ = chooseTransform(box, job_.voxelize);
    requireArrayRoom(job_, box, transform_);
    MesherChoice& choice =
        result_.mesher.emplace(chooseMesher(job_, diagonalOf(box), transform_.voxelSize));
    if (choice.method != Mesher::Envelope)
      return;
    TetrahedralizeOptions options;
    options.epsilon = choice.epsilon;
    options.maxMemory = job_.maxMemory == 0 ? availableBytes() : memoryLeft(job_.maxMemory);
    progress_.stage("tetrahedralize");
    MesherStop stop;
    std::optional<Tetrahedralization> made;
    if (needsTets(job_))
      made = tetrahedralize(meshes_, options, report_, progress_);
    else
      made = meshWithinLimits(meshes_, options, stop, report_, progress_);
    if (!made) {
      choice = {Mesher::Winding, "the envelope mesher was stopped: " + stop.why, 0};
      report_.warn("fell-back", "the envelope mesher was stopped, since " + stop.why +
                                    "; the winding number decides what is inside instead");
      report_.partial = report_.partial || stop.status != Status::Invalid;
      return;
    }
    takeTets(std::move(*made));
  }

  void requireShards() const {
    if (byTets())
      throw Error(Status::Usage, "`shard`", "is for the winding number, not for tets made here",
                  "make the tets first, or leave `mesher=envelope` and `epsilon` out");
  }

  void takeTets(Tetrahedralization&& made) {
    result_.made = summarize(std::move(made), tets_);
    result_.tets = result_.made->tets;
    result_.volume = result_.made->statistics.volume;
    if (!job_.preview.empty())
      preview_.tets(tets_, report_, progress_);
    if (meshes_.size() == job_.inputs.size())
      for (const std::string& name : uniqueStems(job_.inputs))
        tets_.regionNames[static_cast<std::int32_t>(tets_.regionNames.size()) + 1] = name;
    for (const TriangleMesh& mesh : meshes_)
      result_.openEdges += soupBoundary(mesh, progress_).edges.size();
    if (job_.meshOutput.empty() || !writesTriangles(job_.meshOutput))
      meshes_ = {}; // their memory serves the grids
  }

  // Where the job names none.
  std::map<std::string, std::string> unitsFound() const {
    if (!job_.units.empty() || units_.empty())
      return {};
    return {{"units", units_}};
  }

  // Each input is then cleaned for itself.
  bool asMaterials() const {
    return job_.makesVolume() && contains(job_.grids, GridKind::Material);
  }

  bool byTets() const { return result_.mesher->method == Mesher::Envelope; }

  Voxelization makeGrids(const VoxelizeOptions& options) {
    return withShapes(
        job_, options, [&](const VoxelizeOptions& more) { return voxelizeSolid(more); },
        [&](const ShapeOptions& shapes, Voxelization& made) {
          result_.shapes = byTets() ? addShapeGrids(tets_, shapes, made, report_, progress_)
                                    : addShapes(shapes, made);
        },
        [&](const ShapeOptions& shapes, const GridTransform& transform) {
          return byTets()
                     ? shapesOnDevice(tets_, transform, shapes, result_.shapes, report_, progress_)
                     : shapesOnDevice(meshes_.front(), job_.solid, transform, shapes,
                                      result_.shapes, report_, progress_);
        },
        nanoPlace(job_, nano_));
  }

  ShapeSums addShapes(const ShapeOptions& shapes, Voxelization& made) {
    if (meshes_.size() == 1)
      return addShapeGrids(meshes_.front(), job_.solid, shapes, made, report_, progress_);
    Report told; // of mixed units, when the files were read
    const TriangleMesh all = mergeMeshes(std::vector<TriangleMesh>(meshes_), told);
    return addShapeGrids(all, job_.solid, shapes, made, report_, progress_);
  }

  Voxelization voxelizeSolid(VoxelizeOptions options) {
    if (!byTets()) {
      if (asMaterials() && job_.device.kind == DeviceKind::Cuda)
        report_.warn("device-unused", "materials of triangles are found on the CPU");
      Voxelization made =
          asMaterials()
              ? voxelizeMaterials(meshes_, job_.inputs, job_.solid, options, report_, progress_)
              : voxelize(meshes_.front(), job_.solid, options, job_.device, result_.device,
                         nanoPlace(job_, nano_), report_, progress_);
      result_.openEdges = made.counts.openEdges;
      return made;
    }
    keepWithinSize();
    options.voxelSize = transform_.voxelSize;
    options.origin = transform_.origin;
    reportTransform(transform_, job_.voxelize, report_);
    return voxelize(tets_, options, job_.device, result_.device, nanoPlace(job_, nano_), report_,
                    progress_);
  }

  // Voxels lie where they lie without tets: by the triangles' box. Where the tets reach so far
  // beyond it that they could have more voxels than were asked for, by the tets' own.
  void keepWithinSize() {
    const VoxelizeOptions& asked = job_.voxelize;
    if (asked.voxelSize[0] != 0)
      return;
    const WorldBox box = boxOfUsed(tets_.points, tets_.tets);
    const bool within = asked.fit.voxels > 0
                            ? isWithinFit(box, transform_, asked.fit)
                            : isWithinResolution(box, transform_, asked.resolution);
    if (!within)
      transform_ = chooseTransform(box, asked);
  }

  void writeMesh() {
    if (!writesTriangles(job_.meshOutput))
      return writeTetMesh(job_.meshOutput, tets_, progress_);
    Report told; // of mixed units, when the files were read
    writeTriangles(job_.meshOutput, mergeMeshes(std::move(meshes_), told), progress_);
  }

  const VoxelizeJob& job_;
  VoxelizeResult& result_;
  Report& report_;
  Progress& progress_;
  Preview preview_;
  std::vector<TriangleMesh> meshes_; ///< one, or one a material
  std::string units_;
  GridTransform transform_;
  std::vector<NanoBytes> nano_;
  TetMesh tets_;
};

void refuseMesherForTets(const VoxelizeJob& job) {
  if (job.mesher == Mesher::Envelope || job.epsilon.value > 0)
    throw Error(Status::Usage, job.epsilon.value > 0 ? "`epsilon`" : "`mesher=envelope`",
                "is for triangles; the input is tetrahedra", "leave it out");
}

VoxelizeResult runHere(const VoxelizeJob& job, Report& report, Progress& progress) {
  VoxelizeResult result;
  checkOutputs(job);
  requireStreamable(job);
  requireDevice(job.device);
  if (std::any_of(job.inputs.begin(), job.inputs.end(), isPreparedMesh))
    return runPrepared(job, report, progress);
  result.holdsTriangles = inputsHoldTriangles(job);
  if (job.device.kind == DeviceKind::Cuda)
    for (const GridKind kind : job.grids)
      if (!infoOf(kind).onDevice)
        report.warn("device-unused", fmt::format("{} is found on the CPU", infoOf(kind).name));
  if (result.holdsTriangles) {
    TriangleRun(job, result, report, progress).run();
  } else {
    refuseMesherForTets(job);
    runTets(job, result, report, progress);
  }
  return result;
}

} // namespace

VoxelizeResult run(const VoxelizeJob& job, Report& report, Progress& progress) {
  return inArena(job.threads, [&] { return runHere(job, report, progress); });
}

} // namespace tetvdb
