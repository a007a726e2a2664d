// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/SliceJob.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/pipeline/CleanInput.h"
#include "tetvdb/pipeline/MergeMeshes.h"
#include "tetvdb/pipeline/MeshObjects.h"
#include "tetvdb/pipeline/OpenLayers.h"
#include "tetvdb/print/ErrorDiffusion.h"
#include "tetvdb/print/GridLayers.h"
#include "tetvdb/print/LayerSource.h"
#include "tetvdb/print/LayerStack.h"
#include "tetvdb/print/MeshLayers.h"
#include "tetvdb/print/PlateMap.h"
#include "tetvdb/surface/ExtractSurface.h"
#include "tetvdb/surface/LocalRepair.h"
#include "tetvdb/surface/TetSurface.h"
#include "tetvdb/surface/TriangleScene.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/SoupBoundary.h"
#include "tetvdb/voxelize/VoxelizeMaterials.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kMillimetres = 1000; // in a metre

const char* nameOf(SliceAa aa) {
  constexpr const char* kNames[] = {"volume", "area", "none"};
  return kNames[static_cast<std::size_t>(aa)];
}

// Distinct colours for materials, starting with white.
std::vector<PngColor> paletteOf(std::size_t materials) {
  constexpr PngColor kColors[] = {{255, 255, 255}, {230, 159, 0}, {86, 180, 233}, {0, 158, 115},
                                  {240, 228, 66},  {0, 114, 178}, {213, 94, 0},   {204, 121, 167}};
  std::vector<PngColor> palette = {{0, 0, 0}};
  for (std::size_t i = 0; i < materials; ++i) {
    PngColor color = kColors[i % std::size(kColors)];
    for (std::uint8_t& channel : color) // darker in each cycle
      channel = static_cast<std::uint8_t>(channel >> std::min<std::size_t>(i / 8, 3));
    palette.push_back(color);
  }
  return palette;
}

class Slicing {
public:
  Slicing(const SliceJob& job, Report& report, Progress& progress)
      : job_(job), report_(report), progress_(progress),
        format_(layerFormatFor(job.output, job.format)), grey_(job.grey) {
    if (job.dither)
      grey_.levels = 256;
  }

  SliceResult run() {
    check();
    checkOutput();
    info_.path = job_.output;
    info_.printer = job_.printer;
    info_.printer.gamma = job_.grey.gamma;
    info_.aa = nameOf(job_.aa);
    write(*source());
    return std::move(result_);
  }

  OpenedLayers open(const OpenOptions& options) {
    check();
    open_ = options;
    OpenedLayers opened;
    opened.source = source();
    opened.result = std::move(result_);
    opened.result.frame = info_.frame;
    opened.printer = job_.printer;
    opened.map = map_;
    opened.mesh = std::move(kept_);
    return opened;
  }

private:
  std::unique_ptr<LayerSource> source() {
    if (job_.isVolume)
      return fromVolume();
    if (job_.materials)
      return fromMaterials();
    return fromMesh(holdsTriangles(job_.inputs.front(), job_.memory) ? readTriangleInputs()
                                                                     : readTetInput());
  }

  void checkOutput() {
    requireSeparateFiles(filesAmong(job_.inputs, job_.memory), {job_.output});
    if (job_.keep && (!job_.output.empty() || format_.contours))
      throw Error(Status::Usage, "", "layers are returned as pixels instead of a file",
                  "give an output only, or none");
    if (!format_.endings.empty() && !job_.keep)
      requireWritable(job_.output);
    if (job_.materials && !format_.takesMaterials)
      throw Error(Status::Usage, "`materials`",
                  fmt::format("the format {} has no materials", format_.name),
                  "write a folder of PNG files");
  }

  void check() {
    checkPrinter(job_.printer);
    GreyLevels{job_.grey};
    if (job_.inputs.empty())
      throw Error(Status::Usage, "", "no input was given");
    if (job_.isVolume && job_.inputs.size() > 1)
      throw Error(Status::Usage, job_.inputs[1], "a volume must be the only input",
                  "give one input at a time");
    if (job_.dither && (asksCentres() || format_.contours || job_.grey.table))
      throw Error(
          Status::Usage, "`dither`",
          "distributes the rounding of grey levels, not with `aa=none`, `materials`, `lut` or "
          "contours",
          "leave it out");
    const bool offsets = job_.printer.xyOffset != 0 || job_.printer.footOffset != 0;
    if (offsets && (asksCentres() || format_.contours))
      throw Error(Status::Usage, "`xy_offset`, `foot_offset`",
                  "require grey levels: `aa=volume` or area, and a format of pixels",
                  "set them to 0 (absolute_correction and elefant_foot_compensation in the "
                  "printer's file)");
    if (asksCentres() && job_.printer.firstHeight() != job_.printer.layerHeight)
      throw Error(Status::Usage, "`first_layer_height`", "layers of whole voxels have one height",
                  "leave it out, or use `aa=volume`");
  }

  template <typename Work>
  auto stage(const char* name, const Work& work) {
    StageTimer timer(report_, name);
    progress_.stage(name);
    return work();
  }

  // Millimetres per unit of the input.
  double scaleOf(const std::string& fileUnits) const {
    const std::string& units = job_.units.empty() ? fileUnits : job_.units;
    const double metres = metresOf(units);
    return job_.place.scale * (metres > 0 ? metres * kMillimetres : 1);
  }

  std::vector<TriangleMesh> readAll() {
    std::vector<TriangleMesh> meshes = stage("read", [&] {
      std::vector<TriangleMesh> all;
      for (const std::string& input : job_.inputs) {
        if (!holdsTriangles(input, job_.memory))
          throw Error(Status::Usage, input, "has no triangles, unlike the previous input",
                      "slice them one by one");
        all.push_back(
            readSoup(input, &result_.inputs.emplace_back(), report_, progress_, job_.memory));
      }
      return all;
    });
    haveOneUnit(meshes, report_);
    return meshes;
  }

  // Whether only the winding number of voxel centres is required, which needs no closed faces.
  bool asksCentres() const {
    return job_.materials || (job_.aa == SliceAa::None && !format_.contours);
  }

  void clean(TriangleMesh& mesh, const std::string& name) {
    const CleanOptions clean = asksCentres() ? cleaningFor(SolidOptions{}, job_.clean) : job_.clean;
    result_.cleaned = cleanInput(mesh, name, clean, report_, progress_);
    if (asksCentres())
      return;
    const std::size_t open = soupBoundary(mesh, progress_).edges.size();
    if (open == 0)
      return;
    const LocalRepair repair = repairLocally(mesh, progress_);
    if (!repair.succeeded)
      return remesh(mesh, name, open, repair.why);
    result_.repaired = true;
    report_.warn("repaired", fmt::format("{}: had {} open edges; {} holes were filled", name, open,
                                         repair.holes.size()));
  }

  // The surface of the voxels that are inside by the winding number.
  void remesh(TriangleMesh& mesh, const std::string& name, std::size_t open,
              const std::string& why) {
    const LayerFrame frame = frameOf(job_.printer, job_.printer.layerHeight, LayerShare::Volume);
    const double side =
        std::max({frame.pixelWidth, frame.pixelHeight, frame.layerHeight}) / scaleOf(mesh.units);
    VoxelizeOptions options;
    options.voxelSize = {side, side, side};
    options.grids = {GridKind::Mask};
    options.allowEmpty = true;
    options.maxMemory = memoryLeft(job_.maxMemory);
    const Volume volume = voxelize(mesh, {}, options, report_, progress_).volume;
    if (volume.grids().all.front()->empty())
      throw Error(Status::Invalid, name,
                  fmt::format("has {} open edges and encloses nothing", open),
                  "give the sheet a thickness with `shell=T` of repair");
    const TriangleScene scene(mesh);
    ExtractOptions extract;
    extract.original = &scene;
    extract.simplify = 0;
    extract.maxMemory = memoryLeft(job_.maxMemory);
    TriangleMesh surface = extractSurface(volume, extract, progress_);
    surface.units = mesh.units;
    mesh = std::move(surface);
    result_.remeshed = true;
    report_.warn(
        "remeshed",
        fmt::format("{}: had {} open edges, and repairing them failed ({}): the surface was "
                    "remade from voxels of {:.6g}, and details finer than that are lost",
                    name, open, why, side));
  }

  TriangleMesh readTriangleInputs() {
    std::vector<TriangleMesh> meshes = readAll();
    return stage("clean", [&] {
      TriangleMesh all = mergeMeshes(std::move(meshes), report_);
      clean(all, job_.inputs.size() == 1 ? job_.inputs.front() : "the inputs");
      return all;
    });
  }

  TetMesh readTetMesh() {
    result_.source = SolidSource::Tets;
    if (job_.inputs.size() > 1)
      throw Error(Status::Usage, job_.inputs[1], "several inputs must be triangles",
                  "slice meshes of tets one by one");
    ReadOptions options;
    options.attributes = false;
    return stage("read", [&] {
      return readTets(job_.inputs.front(), options, {}, &result_.inputs.emplace_back(), report_,
                      progress_, job_.memory);
    });
  }

  TriangleMesh readTetInput() {
    const TetMesh mesh = readTetMesh();
    return stage("clean", [&] { return tetSurface(mesh, progress_); });
  }

  PlateMap place(const WorldBox& box, const std::string& fileUnits) {
    PlaceOptions options = job_.place;
    options.scale = scaleOf(fileUnits);
    WorldBox grown = box; // the outlines grow by this
    for (std::size_t k = 0; k < 2; ++k) {
      const double by =
          std::max(job_.printer.xyOffset, 0.0) / (options.scale * job_.printer.stretch[k]);
      grown.min[k] -= by;
      grown.max[k] += by;
    }
    if (open_.fit)
      open_.fit(mapToPlate(grown, job_.printer, options).box, job_.printer, options);
    map_ = placeOnPlate(grown, job_.printer, options);
    result_.box = info_.box = map_.box;
    return map_;
  }

  // In addition to the mesh: faces in order of layers, the pairs of a slab, the layers in progress.
  void requireRoom(const TriangleMesh& mesh) const {
    constexpr std::size_t kBytesPerFace = 24, kForLayers = std::size_t(64) << 20;
    const std::size_t needed = kBytesPerFace * mesh.triangleCount() + kForLayers;
    const std::size_t left = job_.maxMemory > 0 ? memoryLeft(job_.maxMemory) : availableBytes();
    if (left > 0 && needed > left)
      throw Error(
          Status::Limit, "",
          fmt::format("cutting needs about {} MB, there are {}", needed / 1000000, left / 1000000),
          "raise `max_memory`, or use a machine with more");
  }

  std::unique_ptr<LayerSource> fromMesh(TriangleMesh mesh) {
    requireRoom(mesh);
    const PlateMap map = place(boxOfUsed(mesh.points, mesh.triangles), mesh.units);
    return stage("cut", [&]() -> std::unique_ptr<LayerSource> {
      result_.meshVolume = volumeOf(mesh) * map.scale[0] * map.scale[1] * map.scale[2];
      if (open_.keepMesh)
        kept_ = mesh;
      if (format_.needsMesh) {
        mesh_ = mesh;
        for (Vec3d& p : mesh_.points)
          p = map(p);
        info_.mesh = &mesh_;
      }
      if (asksCentres())
        return maskOf(std::move(mesh), map);
      const LayerShare share = format_.contours             ? LayerShare::Contours
                               : job_.aa == SliceAa::Volume ? LayerShare::Volume
                                                            : LayerShare::Area;
      info_.frame = frameOf(job_.printer, map.box.max[2], share);
      return std::make_unique<MeshLayers>(
          framedFaces(std::move(mesh.points), std::move(mesh.triangles), map, job_.printer, share),
          info_.frame, share, GreyLevels(grey_), offset());
    });
  }

  LayerOffset offset() const {
    return {job_.printer.xyOffset, job_.printer.footOffset, std::max(job_.printer.fadedLayers, 1)};
  }

  // Voxels that equal the image's pixels, one unit each along x and y.
  VoxelizeOptions pixelVoxels() const {
    VoxelizeOptions options;
    const double height = job_.printer.layerHeight;
    options.voxelSize = {1, 1, height};
    options.origin = {0.5, 0.5, height / 2};
    options.maxMemory = memoryLeft(job_.maxMemory);
    return options;
  }

  // The pixel of a voxel of that grid; its origin may have been moved.
  VoxelToPixel pixelsOf(const Voxelization& made) const {
    const auto moved = [&](std::size_t axis) {
      return std::llround(made.transform.origin[axis] / made.transform.voxelSize[axis] - 0.5);
    };
    VoxelToPixel map;
    map.x = moved(0);
    map.y = moved(1);
    map.z = moved(2);
    return map;
  }

  TriangleMesh inImage(TriangleMesh mesh, const PlateMap& map) const {
    FrameFaces faces = framedFaces(std::move(mesh.points), std::move(mesh.triangles), map,
                                   job_.printer, LayerShare::Area);
    if (faces.mirrored)
      for (std::size_t t = 0; t < faces.triangles.size(); t += 3)
        std::swap(faces.triangles[t], faces.triangles[t + 1]);
    mesh.points = std::move(faces.points);
    mesh.triangles = std::move(faces.triangles);
    return mesh;
  }

  std::unique_ptr<LayerSource> maskOf(TriangleMesh mesh, const PlateMap& map) {
    info_.frame = frameOf(job_.printer, map.box.max[2], LayerShare::Area);
    VoxelizeOptions options = pixelVoxels();
    options.grids = {GridKind::Mask};
    const Voxelization made =
        voxelize(inImage(std::move(mesh), map), {}, options, report_, progress_);
    return gridLayers(made.volume.grids().all.front(), info_.frame, pixelsOf(made),
                      GreyLevels(grey_));
  }

  std::unique_ptr<LayerSource> fromMaterials() {
    return holdsTriangles(job_.inputs.front(), job_.memory) ? materialsOfTriangles()
                                                            : materialsOfTets();
  }

  std::unique_ptr<LayerSource> materialGrid(const Voxelization& made,
                                            const std::vector<std::string>& names) {
    if (names.size() > 255)
      throw Error(Status::Limit, "`materials`",
                  fmt::format("{} materials are more than a palette has, 255", names.size()));
    result_.materials = names;
    info_.materials = {"background"};
    info_.materials.insert(info_.materials.end(), names.begin(), names.end());
    info_.palette = paletteOf(names.size());
    return gridLayers(made.volume.grids().all.front(), info_.frame, pixelsOf(made),
                      GreyLevels(grey_));
  }

  std::unique_ptr<LayerSource> materialsOfTriangles() {
    std::vector<TriangleMesh> meshes = readAll();
    std::vector<std::string> names = uniqueStems(job_.inputs);
    stage("clean", [&] {
      for (std::size_t i = 0; i < meshes.size(); ++i)
        clean(meshes[i], job_.inputs[i]);
    });
    const PlateMap map = place(boxOf(meshes), meshes.front().units);
    info_.frame = frameOf(job_.printer, map.box.max[2], LayerShare::Area);
    for (TriangleMesh& mesh : meshes)
      mesh = inImage(std::move(mesh), map);
    VoxelizeOptions options = pixelVoxels();
    options.grids = {GridKind::Material};
    return materialGrid(voxelizeMaterials(meshes, names, {}, options, report_, progress_), names);
  }

  // Regions in order of their numbers are materials 1, 2, ...
  std::unique_ptr<LayerSource> materialsOfTets() {
    TetMesh mesh = readTetMesh();
    std::vector<std::int32_t> numbers = mesh.regions;
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    if (numbers.empty())
      throw Error(Status::Usage, "`materials`", "the mesh has no regions", "leave it out");
    std::vector<std::string> names;
    for (const std::int32_t number : numbers) {
      const auto name = mesh.regionNames.find(number);
      names.push_back(name == mesh.regionNames.end() ? std::to_string(number) : name->second);
    }
    for (std::int32_t& region : mesh.regions)
      region = static_cast<std::int32_t>(std::lower_bound(numbers.begin(), numbers.end(), region) -
                                         numbers.begin()) +
               1;
    const PlateMap map = place(boxOfUsed(mesh.points, mesh.tets), "");
    info_.frame = frameOf(job_.printer, map.box.max[2], LayerShare::Area);
    mesh.points =
        framedFaces(std::move(mesh.points), {}, map, job_.printer, LayerShare::Area).points;
    VoxelizeOptions options = pixelVoxels();
    options.grids = {GridKind::Material};
    Report told; // tets that are mirrored by the image need no warning
    return materialGrid(voxelize(mesh, options, told, progress_), names);
  }

  std::unique_ptr<LayerSource> fromVolume() {
    result_.source = SolidSource::Volume;
    const std::string& path = job_.inputs.front();
    Volume volume =
        stage("read", [&] { return readVolumeInput(path, report_, progress_, job_.memory); });
    if (!format_.contours)
      if (auto source = directVoxels(volume))
        return source;
    if (job_.materials)
      throw Error(Status::Usage, "`materials`", "the volume's voxels are not the printer's pixels",
                  "voxelize with `voxel_size` of the pixels and the layer height");
    TriangleMesh mesh = stage("extract", [&] {
      ExtractOptions options;
      options.grid = job_.grid;
      options.simplify = 0;
      options.maxMemory = memoryLeft(job_.maxMemory);
      return extractSurface(volume, options, progress_);
    });
    mesh.units = unitsOf(volume);
    return fromMesh(std::move(mesh));
  }

  static std::string unitsOf(const Volume& volume) {
    const auto found = volume.metadata.find("units");
    return found == volume.metadata.end() ? "" : found->second;
  }

  openvdb::GridBase::Ptr chooseGrid(const Volume& volume) const {
    for (const auto& grid : volume.grids().all)
      if (job_.grid.empty() ? grid->isType<openvdb::BoolGrid>() || isShare(*grid) ||
                                  (job_.materials && grid->isType<openvdb::Int32Grid>())
                            : grid->getName() == job_.grid)
        return grid;
    return nullptr;
  }

  static bool isShare(const openvdb::GridBase& grid) {
    return grid.isType<openvdb::FloatGrid>() && grid.getName() == "coverage";
  }

  // Null if the voxels do not match the printer's.
  std::unique_ptr<LayerSource> directVoxels(const Volume& volume) {
    constexpr double kSame = 1e-6; // relative difference of sizes
    const openvdb::GridBase::Ptr grid = chooseGrid(volume);
    if (!grid || job_.printer.portrait || job_.printer.firstHeight() != job_.printer.layerHeight)
      return nullptr;
    const bool direct = grid->isType<openvdb::BoolGrid>() || isShare(*grid) ||
                        (job_.materials && grid->isType<openvdb::Int32Grid>());
    if (!direct || !grid->transform().isLinear())
      return nullptr;
    const double scale = scaleOf(unitsOf(volume));
    const LayerFrame pixels = frameOf(job_.printer, job_.printer.layerHeight, LayerShare::Volume);
    const std::array<double, 3> wanted = {pixels.pixelWidth, pixels.pixelHeight,
                                          pixels.layerHeight};
    const openvdb::Vec3d size = grid->voxelSize();
    for (std::size_t k = 0; k < 3; ++k)
      if (std::abs(size[static_cast<int>(k)] * scale * job_.printer.stretch[k] / wanted[k] - 1) >
          kSame)
        return nullptr;
    return stage("cut", [&] { return placedVoxels(*grid, grid, wanted); });
  }

  std::unique_ptr<LayerSource> placedVoxels(const openvdb::GridBase& grid,
                                            const openvdb::GridBase::ConstPtr& shared,
                                            const std::array<double, 3>& pixel) {
    const openvdb::CoordBBox active = grid.evalActiveVoxelBoundingBox();
    if (active.empty())
      throw Error(Status::Invalid, job_.inputs.front(), "the grid has no active voxels");
    // In millimetres, as if voxel 0 began at 0; with kept coordinates it begins there.
    WorldBox box;
    PlaceOptions options = job_.place;
    options.scale = 1;
    const openvdb::Vec3d origin = grid.transform().indexToWorld(openvdb::Vec3d(-0.5));
    const double scale = scaleOf("");
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      const double first = options.keep ? origin[k] * scale * job_.printer.stretch[axis] : 0;
      box.min[axis] = first + active.min()[axis] * pixel[axis];
      box.max[axis] = first + (active.max()[axis] + 1.0) * pixel[axis];
    }
    PrinterSettings plain = job_.printer; // the voxels are stretched
    plain.stretch = {1, 1, 1};
    if (open_.fit) {
      open_.fit(mapToPlate(box, plain, options).box, job_.printer, options);
      plain = job_.printer;
      plain.stretch = {1, 1, 1};
    }
    const PlateMap map = placeOnPlate(box, plain, options);
    result_.box = info_.box = map.box;
    info_.frame = frameOf(job_.printer, map.box.max[2], LayerShare::Volume);
    // The first voxel's corner on the plate, in whole pixels.
    const auto start = [&](std::size_t axis) {
      return std::llround(map.box.min[axis] / pixel[axis]);
    };
    VoxelToPixel to;
    to.reverseX = job_.printer.mirror[0];
    to.reverseY = !job_.printer.mirror[1];
    const std::int64_t x = start(0) - active.min().x(), y = start(1) - active.min().y();
    to.x = to.reverseX ? info_.frame.width - 1 - x : x;
    to.y = to.reverseY ? info_.frame.height - 1 - y : y;
    to.z = start(2) - active.min().z();
    const openvdb::Vec3d corner = grid.transform().indexToWorld(active.min() - openvdb::Vec3d(0.5));
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      map_.scale[axis] = pixel[axis] / grid.voxelSize()[k];
      map_.offset[axis] =
          static_cast<double>(start(axis)) * pixel[axis] - corner[k] * map_.scale[axis];
    }
    if (job_.materials) {
      std::vector<std::string> names;
      for (int material = 1; material < 256; ++material)
        names.push_back(std::to_string(material));
      result_.materials = names;
      info_.palette = paletteOf(names.size());
    }
    return gridLayers(shared, info_.frame, to, GreyLevels(grey_));
  }

  void write(LayerSource& source) {
    StageTimer timer(report_, "layers");
    progress_.stage("layers");
    const std::unique_ptr<LayerWriter> writer =
        job_.keep ? layerStack(info_.frame, job_.maxMemory, result_.kept) : format_.make(info_);
    const LayerFrame& frame = info_.frame;
    const int ditherLevels = !job_.dither ? 256 : format_.oneBit ? 2 : job_.grey.levels;
    const double pixel = format_.contours ? 1 : frame.pixelWidth * frame.pixelHeight;
    forEachLayer(
        source,
        [&](std::int32_t k, Layer&& layer) {
          if (ditherLevels < 256)
            diffuseErrors(layer, frame.width, ditherLevels);
          return writer->encode(k, layer);
        },
        [&](std::int32_t k, EncodedLayer&& layer) {
          writer->add(k, layer);
          result_.volume += layer.filled * pixel * frame.heightOf(k);
          result_.overlap += layer.overlap * pixel * frame.heightOf(k);
          result_.emptyLayers += layer.empty ? 1 : 0;
        },
        progress_);
    writer->finish();
    result_.frame = frame;
    result_.format = format_.name;
    if (!job_.keep)
      result_.output = {job_.output, writer->bytes()};
    if (result_.emptyLayers > 0)
      report_.warn("empty-layers",
                   fmt::format("{} of {} layers are empty", result_.emptyLayers, frame.layers));
    if (result_.overlap > 1e-6 * result_.volume)
      report_.warn("overlap",
                   fmt::format("components of the model overlap: {:.6g} mm3 that are filled "
                               "more than once are counted once",
                               result_.overlap));
  }

  SliceJob job_; ///< its printer is that of OpenOptions::fit
  Report& report_;
  Progress& progress_;
  const LayerFormat& format_;
  GreyOptions grey_; ///< of the source; diffusion follows it
  PrintInfo info_;
  TriangleMesh mesh_; ///< on the plate, if the format requires it
  SliceResult result_;
  OpenOptions open_;
  PlateMap map_;      ///< from the input's coordinates
  TriangleMesh kept_; ///< in the input's coordinates
};

} // namespace

OpenedLayers openLayers(const SliceJob& job, const OpenOptions& options, Report& report,
                        Progress& progress) {
  return inArena(job.threads, [&] { return Slicing(job, report, progress).open(options); });
}

SliceResult run(const SliceJob& job, Report& report, Progress& progress) {
  return inArena(job.threads, [&] { return Slicing(job, report, progress).run(); });
}

} // namespace tetvdb
