// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/dataset/MakeItem.h"

#include "nanovdb_kernels/DeviceArray.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/HashText.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/fields/ShapesOnDevice.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/pipeline/CleanInput.h"
#include "tetvdb/pipeline/FitVolume.h"
#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/pipeline/SolidQuery.h"
#include "tetvdb/pipeline/dataset/GridArrays.h"
#include "tetvdb/pipeline/dataset/Hdf5Arrays.h"
#include "tetvdb/pipeline/dataset/NamedArray.h"
#include "tetvdb/pipeline/dataset/ZarrArrays.h"
#include "tetvdb/surface/TetSurface.h"
#include "tetvdb/tetrahedralize/Tetrahedralize.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/SoupBoundary.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <limits>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

constexpr double kSharpDegrees = 30;
const char* const kSurfaceVoxels = "shell";

struct PointSet {
  std::vector<Vec3d> points;
  std::vector<std::uint8_t> inside;
  std::vector<double> distance;
};

class ItemMaker {
public:
  /// Writes files into `folder`, or adds arrays to `kept`.
  ItemMaker(const DatasetItem& item, const DatasetOptions& options, const std::string& folder,
            std::vector<NamedArray>* kept, Report& report, Progress& progress)
      : item_(item), options_(options), folder_(folder), kept_(kept), report_(report),
        progress_(progress) {}

  ItemResult make() {
    read();
    clean();
    const std::uint64_t seed =
        mixBits(seedOfFile_ + mixBits(options_.seed * kGoldenRatio + std::uint64_t(item_.variant)));
    RandomNumbers random(seed);
    normal_ = normalizeModel(mesh_, options_, item_.variant, random);
    result_.transform = normal_.transform;
    if (item_.variant > 0 && options_.epsilonHigh > 0)
      meshWithin(random);
    arrays_.push_back(
        NamedArray::of("transform", "<f8", {4, 4},
                       std::vector<double>(normal_.transform.begin(), normal_.transform.end())));
    for (const int size : options_.resolutions)
      grids(size);
    if (options_.content.points || options_.content.samples)
      points(random);
    if (kept_ != nullptr)
      *kept_ = std::move(arrays_);
    else
      writeArrayFiles();
    return std::move(result_);
  }

private:
  bool writes(DatasetFormat format) const {
    return kept_ == nullptr && std::find(options_.formats.begin(), options_.formats.end(),
                                         format) != options_.formats.end();
  }
  bool makesArrays() const {
    return kept_ != nullptr || writes(DatasetFormat::Npz) || writes(DatasetFormat::Npy) ||
           writes(DatasetFormat::Hdf5) || writes(DatasetFormat::Zarr);
  }

  void read() {
    const StageTimer timer(report_, "read");
    progress_.stage("read");
    const std::string& path = item_.entry.path;
    {
      const MappedFile file(path);
      const XXH128_hash_t hash = XXH3_128bits(file.bytes().data(), file.bytes().size());
      result_.fileHash = textOf(hash);
      seedOfFile_ = hash.low64;
    }
    mesh_ = holdsTriangles(path)
                ? readSoup(path, nullptr, report_, progress_)
                : tetSurface(readTets(path, {}, {}, nullptr, report_, progress_), progress_);
    result_.faces = mesh_.triangleCount();
  }

  void clean() {
    const StageTimer timer(report_, "clean");
    progress_.stage("clean");
    const CleanOptions clean = cleaningFor(SolidOptions{}, options_.clean);
    closingFaces_ = cleanInput(mesh_, "", clean, report_, progress_).closingFaces;
    result_.cleanFaces = mesh_.triangleCount();
    result_.openEdges = soupBoundary(mesh_, progress_).edges.size();
  }

  // The mesh without the faces that cleaning added.
  TriangleMesh givenFaces() const {
    TriangleMesh mesh = mesh_;
    mesh.faceCount = mesh.triangleCount() - closingFaces_;
    mesh.triangles.resize(3 * mesh.faceCount);
    return mesh;
  }

  // The surface of tets within a random epsilon.
  void meshWithin(RandomNumbers& random) {
    const double low = std::log(options_.epsilonLow), high = std::log(options_.epsilonHigh);
    const double share = std::exp(low + (high - low) * random.uniform());
    const WorldBox box = boxOfUsed(mesh_.points, mesh_.triangles);
    TetrahedralizeOptions how;
    how.epsilon = share * length(minus(box.max, box.min));
    how.maxMemory = options_.maxMemory;
    mesh_ = tetSurface(tetrahedralize({mesh_}, how, report_, progress_).mesh, progress_);
    closingFaces_ = 0;
  }

  VoxelizeOptions cubeOf(int size) const {
    VoxelizeOptions how;
    const double voxel = normal_.side / size;
    how.voxelSize = {voxel, voxel, voxel};
    for (std::size_t axis = 0; axis < 3; ++axis)
      how.origin[axis] = normal_.centre[axis] - normal_.side / 2 + voxel / 2;
    how.grids = {GridKind::Mask};
    how.maxMemory = options_.maxMemory;
    return how;
  }

  static VoxelBox boxOf(int size) { return {{0, 0, 0}, {size - 1, size - 1, size - 1}}; }

  void grids(int size) {
    const DatasetContent& content = options_.content;
    const bool solid =
        content.occupancy || content.distance || (content.coordinates && !content.surface);
    if (keepsOnDevice() && (content.occupancy || content.distance) && !content.coordinates &&
        !content.surface && makeOnDevice(size))
      return;
    Volume volume;
    if (solid) {
      DeviceUsed used;
      Voxelization made = voxelize(mesh_, SolidOptions{}, cubeOf(size), options_.device, used,
                                   nullptr, report_, progress_);
      if (content.distance) {
        addShapeGrids(mesh_, SolidOptions{}, distanceOptions(size), made, report_, progress_);
      }
      volume = made.volume;
      describeGrid(volume, size);
    }
    if (content.surface)
      addSurfaceVoxels(volume, size);
    clip(volume, size);
    volume.metadata["creator"] = std::string("TetVDB ") + version();
    volume.metadata["source"] = fs::path(item_.entry.path).filename().string();
    write(volume, size);
  }

  bool keepsOnDevice() const {
    return kept_ != nullptr && options_.device.kind == DeviceKind::Cuda;
  }

  ShapeOptions distanceOptions(int size) const {
    ShapeOptions shapes;
    shapes.grids = {GridKind::Surface};
    shapes.halfWidth = options_.bandVoxels;
    shapes.box = boxOf(size);
    shapes.maxMemory = options_.maxMemory;
    shapes.device = options_.device;
    return shapes;
  }

  // From the mesh to arrays within the GPU; returns whether it can make them.
  bool makeOnDevice(int size) {
    const VoxelizeOptions cube = cubeOf(size);
    const GridTransform transform{cube.voxelSize, cube.origin};
    std::shared_ptr<nano::DeviceArray> inside, distances;
    if (options_.content.distance) {
      distances = distancesOnDevice(mesh_, transform, boxOf(size), distanceOptions(size), report_,
                                    progress_);
      if (distances == nullptr)
        return false;
    }
    if (options_.content.occupancy)
      inside = insideOnDevice(mesh_, transform, boxOf(size), options_.device, report_, progress_);
    addGridMatrix(size);
    const auto add = [&](const char* name, const char* type,
                         std::shared_ptr<nano::DeviceArray> voxels) {
      if (voxels == nullptr)
        return;
      const auto side = static_cast<std::uint64_t>(size);
      NamedArray array;
      array.name = fmt::format("{}_{}", name, size);
      array.type = type;
      array.shape = {side, side, side};
      array.transform = gridMatrix(size);
      array.device = std::move(voxels);
      arrays_.push_back(std::move(array));
    };
    add("occupancy", "|b1", std::move(inside));
    add("distance", "<f4", std::move(distances));
    return true;
  }

  // Cubes that faces pass through: those that the solid meets less those that lie in it.
  void addSurfaceVoxels(Volume& volume, int size) {
    VoxelizeOptions how = cubeOf(size);
    how.allowEmpty = true;
    how.rule = VoxelRule::Any;
    const Voxelization any = voxelize(mesh_, SolidOptions{}, how, report_, progress_);
    how.rule = VoxelRule::All;
    const Voxelization all = voxelize(mesh_, SolidOptions{}, how, report_, progress_);
    const openvdb::GridBase::Ptr met = any.volume.grids().all.front();
    auto& outer = static_cast<openvdb::BoolGrid&>(*met);
    outer.tree().topologyDifference(
        static_cast<const openvdb::BoolGrid&>(*all.volume.grids().all.front()).tree());
    met->setName(kSurfaceVoxels);
    volume.grids().all.push_back(met);
  }

  // Variants may reach out of the cube.
  void clip(Volume& volume, int size) {
    const GridTransform transform{cubeOf(size).voxelSize, cubeOf(size).origin};
    Report ignored; // the narrow band of a level set always ends at the cube's sides
    fitVolume(volume, transform, {size, 0}, ignored);
  }

  void describeGrid(const Volume& volume, int size) {
    ItemGrid grid;
    grid.size = size;
    Volume mask;
    mask.grids().all.push_back(volume.grids().all.front());
    grid.hash = hash(mask);
    grid.occupied = volume.grids().all.front()->activeVoxelCount();
    const double voxel = normal_.side / size;
    if (result_.grids.empty() || size > result_.grids.back().size)
      result_.volume = static_cast<double>(grid.occupied) * voxel * voxel * voxel;
    result_.grids.push_back(std::move(grid));
  }

  // From a voxel's numbers to coordinates as normalised.
  std::vector<double> gridMatrix(int size) const {
    const double voxel = normal_.side / size;
    const Vec3d origin = cubeOf(size).origin;
    return {voxel, 0, 0, origin[0], 0, voxel, 0, origin[1], 0, 0, voxel, origin[2], 0, 0, 0, 1};
  }
  void addGridMatrix(int size) {
    arrays_.push_back(
        NamedArray::of("grid" + fmt::format("_{}", size), "<f8", {4, 4}, gridMatrix(size)));
  }

  // To the GPU; packed booleans as a byte each.
  void moveToDevice(NamedArray& array) const {
    std::uint64_t bytes = array.bytes.size();
    if (array.packed) {
      bytes = 1;
      for (const std::uint64_t side : array.shape)
        bytes *= side;
    }
    array.device = std::make_shared<nano::DeviceArray>(options_.device.numbers.front(), bytes);
    if (array.packed)
      array.device->setBits(0, array.bytes.data(), bytes);
    else
      array.device->set(0, array.bytes.data(), bytes);
    array.bytes.clear();
    array.packed = false;
  }

  void write(const Volume& volume, int size) {
    const StageTimer timer(report_, "write");
    progress_.stage("write");
    const DatasetContent& content = options_.content;
    const std::string suffix = fmt::format("_{}", size);
    if (makesArrays()) {
      addGridMatrix(size);
      const auto addVoxels = [&](NamedArray array) {
        array.transform = gridMatrix(size);
        arrays_.push_back(std::move(array));
      };
      if (content.occupancy)
        addVoxels(activeArray(volume, "mask", size, "occupancy" + suffix));
      if (content.occupancy && keepsOnDevice())
        moveToDevice(arrays_.back());
      if (content.distance)
        addVoxels(valueArray(volume, "surface", size, "distance" + suffix));
      if (content.distance && keepsOnDevice())
        moveToDevice(arrays_.back());
      if (content.surface)
        addVoxels(activeArray(volume, kSurfaceVoxels, size, "surface" + suffix));
      if (content.coordinates && (content.occupancy || !content.surface))
        arrays_.push_back(coordinateArray(volume, "mask", size, "coordinates" + suffix));
      if (content.coordinates && content.surface)
        arrays_.push_back(
            coordinateArray(volume, kSurfaceVoxels, size, "surface_coordinates" + suffix));
    }
    if (writes(DatasetFormat::Binvox)) {
      Volume mask;
      mask.metadata = volume.metadata;
      mask.grids().all.push_back(volume.grids().all.front());
      ArrayOptions box;
      box.box = boxOf(size);
      writeArrays(target(suffix + ".binvox"), mask, box, progress_);
    }
    if (writes(DatasetFormat::Vdb))
      writeVolume(target(suffix + ".vdb"), volume, progress_);
    if (writes(DatasetFormat::Nvdb))
      writeVolume(target(suffix + ".nvdb"), volume, progress_);
  }

  // --- Points.

  PointSet evaluated(const SolidQuery& solid, std::vector<Vec3d> points) {
    PointSet set;
    set.points = std::move(points);
    set.inside.resize(set.points.size());
    set.distance.resize(set.points.size());
    solid.at(set.points.data(), set.points.size(), set.inside.data(), set.distance.data(),
             progress_);
    return set;
  }

  void points(RandomNumbers& random) {
    std::vector<Vec3d> asked;
    SurfacePoints surface;
    {
      const StageTimer timer(report_, "points");
      progress_.stage("points");
      const double unit = normal_.side / (1 + options_.padding);
      if (options_.content.points) {
        for (std::size_t i = 0; i < options_.uniformPoints; ++i) {
          Vec3d point;
          for (std::size_t axis = 0; axis < 3; ++axis)
            point[axis] = normal_.centre[axis] + normal_.side * (random.uniform() - 0.5);
          asked.push_back(point);
        }
        std::vector<Vec3d> near = sampleSurface(mesh_, options_.nearPoints, random).points;
        const std::vector<Vec3d> sharp =
            sampleFeatureEdges(mesh_, kSharpDegrees, options_.sharpPoints, random);
        near.insert(near.end(), sharp.begin(), sharp.end());
        scatter(near, options_.nearDistance * unit, random);
        asked.insert(asked.end(), near.begin(), near.end());
      }
      if (options_.content.samples)
        surface = sampleSurface(givenFaces(), options_.samples, random);
    }
    PointSet set;
    if (options_.content.points) {
      const StageTimer timer(report_, "points");
      set = evaluated(SolidQuery(mesh_, progress_), std::move(asked));
    }
    const StageTimer timer(report_, "write");
    if (makesArrays())
      addPointArrays(set, surface);
    if (writes(DatasetFormat::OccupancyNetworks))
      writeOccupancyNetworks(set, surface);
    if (writes(DatasetFormat::DeepSdf))
      writeDeepSdf(set);
  }

  static std::vector<float> flat(const std::vector<Vec3d>& points) {
    std::vector<float> all;
    all.reserve(3 * points.size());
    for (const Vec3d& point : points)
      for (const double coordinate : point)
        all.push_back(static_cast<float>(coordinate));
    return all;
  }

  NamedArray numbers(std::string name, std::vector<std::uint64_t> shape,
                     const std::vector<float>& values, bool half) const {
    return half ? NamedArray::of(std::move(name), "<f2", std::move(shape), toHalf(values))
                : NamedArray::of(std::move(name), "<f4", std::move(shape), values);
  }

  void addPointArrays(const PointSet& set, const SurfacePoints& surface) {
    const bool half = options_.halfFloats;
    if (options_.content.points) {
      const std::uint64_t n = set.points.size();
      arrays_.push_back(numbers("points", {n, 3}, flat(set.points), half));
      arrays_.push_back(flagArray("points_occupancy", {n}, set.inside));
      const std::vector<float> distance(set.distance.begin(), set.distance.end());
      arrays_.push_back(numbers("points_distance", {n}, distance, half));
    }
    if (options_.content.samples) {
      const std::uint64_t n = surface.points.size();
      arrays_.push_back(numbers("samples", {n, 3}, flat(surface.points), half));
      arrays_.push_back(numbers("normals", {n, 3}, flat(surface.normals), half));
    }
  }

  // points.npz and pointcloud.npz as that project's loader reads them: loc and scale lead from
  // normalised coordinates to the file's.
  void writeOccupancyNetworks(const PointSet& set, const SurfacePoints& surface) {
    const double scale =
        normal_.transform[0] != 0 || normal_.transform[1] != 0 || normal_.transform[2] != 0
            ? 1 / length({normal_.transform[0], normal_.transform[1], normal_.transform[2]})
            : 1;
    const std::vector<double> loc{-normal_.transform[3] * scale, -normal_.transform[7] * scale,
                                  -normal_.transform[11] * scale};
    const NamedArray place = NamedArray::of("loc", "<f8", {3}, loc);
    const NamedArray size = NamedArray::of("scale", "<f8", {}, std::vector<double>{scale});
    const std::uint64_t n = set.points.size(), m = surface.points.size();
    if (options_.content.points)
      writeNpzArrays(target("/points.npz"),
                     {numbers("points", {n, 3}, flat(set.points), true),
                      asBytes(flagArray("occupancies", {n}, set.inside)), place, size});
    if (options_.content.samples)
      writeNpzArrays(target("/pointcloud.npz"),
                     {numbers("points", {m, 3}, flat(surface.points), true),
                      numbers("normals", {m, 3}, flat(surface.normals), true), place, size});
  }

  // Rows of x, y, z and the signed distance, negative inside.
  void writeDeepSdf(const PointSet& set) {
    std::vector<float> inside, outside;
    for (std::size_t i = 0; i < set.points.size(); ++i) {
      std::vector<float>& rows = set.inside[i] != 0 ? inside : outside;
      for (const double coordinate : set.points[i])
        rows.push_back(static_cast<float>(coordinate));
      rows.push_back(static_cast<float>(set.distance[i]));
    }
    writeNpzArrays(target(".sdf.npz"),
                   {NamedArray::of("pos", "<f4", {outside.size() / 4, 4}, outside),
                    NamedArray::of("neg", "<f4", {inside.size() / 4, 4}, inside)});
  }

  // --- Files.

  // A path whose folders exist; it counts as written.
  std::string target(const std::string& ending) {
    fs::path within;
    if (item_.entry.id.find('/') == std::string::npos) {
      within /= item_.entry.split;
      within /= item_.entry.className;
    }
    within /= item_.name() + ending;
    const fs::path path = fs::path(folder_) / within;
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error)
      throw Error(Status::Write, path.parent_path().string(),
                  "the folder cannot be made: " + error.message());
    result_.files.push_back(within.generic_string());
    return path.string();
  }

  void writeArrayFiles() {
    const StageTimer timer(report_, "write");
    const ArrayAttributes about{{{"name", item_.name()},
                                 {"id", item_.entry.id},
                                 {"class", item_.entry.className},
                                 {"split", item_.entry.split}},
                                {normal_.transform.begin(), normal_.transform.end()}};
    if (writes(DatasetFormat::Hdf5))
      writeHdf5Arrays(target(".h5"), arrays_, about);
    if (writes(DatasetFormat::Zarr))
      writeZarrArrays(target(".zarr"), arrays_, about);
    if (!writes(DatasetFormat::Npz) && !writes(DatasetFormat::Npy))
      return;
    for (NamedArray& array : arrays_)
      array = options_.packBits ? asBytes(std::move(array)) : unpacked(std::move(array));
    if (writes(DatasetFormat::Npz))
      writeNpzArrays(target(".npz"), arrays_);
    if (writes(DatasetFormat::Npy))
      for (const NamedArray& array : arrays_)
        writeNpyArray(target("." + array.name + ".npy"), array);
  }

  const DatasetItem& item_;
  const DatasetOptions& options_;
  const std::string& folder_;
  std::vector<NamedArray>* const kept_;
  Report& report_;
  Progress& progress_;
  TriangleMesh mesh_;
  std::size_t closingFaces_ = 0; ///< the last of the mesh, which close its components
  NormalModel normal_;
  std::uint64_t seedOfFile_ = 0;
  std::vector<NamedArray> arrays_;
  ItemResult result_;
};

} // namespace

std::string DatasetItem::name() const {
  return variant == 0 ? entry.id : fmt::format("{}_v{}", entry.id, variant);
}

ItemResult makeItem(const DatasetItem& item, const DatasetOptions& options,
                    const std::string& folder, Report& report, Progress& progress) {
  return ItemMaker(item, options, folder, nullptr, report, progress).make();
}

ItemResult makeItemArrays(const DatasetItem& item, const DatasetOptions& options,
                          std::vector<NamedArray>& arrays, Report& report, Progress& progress) {
  return ItemMaker(item, options, {}, &arrays, report, progress).make();
}

} // namespace tetvdb
