// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/PrepareJob.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/fields/SampleFields.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/pipeline/CleanInput.h"
#include "tetvdb/pipeline/RepairJob.h"
#include "tetvdb/pipeline/RoundForFormat.h"
#include "tetvdb/print/Cavity.h"
#include "tetvdb/print/DrainHoles.h"
#include "tetvdb/print/Infill.h"
#include "tetvdb/print/OffsetSolid.h"
#include "tetvdb/print/Shells.h"
#include "tetvdb/print/SolidDistances.h"
#include "tetvdb/surface/ExtractSurface.h"
#include "tetvdb/surface/MeshChanges.h"
#include "tetvdb/surface/SimplifySurface.h"
#include "tetvdb/surface/TetSurface.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <system_error>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

// Default voxels per length.
constexpr double kVoxelsInWall = 20, kVoxelsInOffset = 8, kVoxelsInClose = 8;
constexpr double kVoxelsInFilledWall = 8, kVoxelsInInfill = 4;
constexpr double kInfillArea = 6; // area of a sheet, both sides, relative to a side of its cell
constexpr std::size_t kMaxDrains = 256;
constexpr double kMinVoxels = 2;      // of a wall, an offset or a radius
constexpr double kMaxFaces = 4e6;     // approximate limit for a surface
constexpr double kFacesPerSquare = 2; // of voxels: marching cubes

void appendFaces(TriangleMesh& mesh, const TriangleMesh& more) {
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), more.points.begin(), more.points.end());
  for (const std::uint32_t v : more.triangles)
    mesh.triangles.push_back(v + first);
  mesh.faceCount = mesh.triangleCount();
}

class Preparing {
public:
  Preparing(const PrepareJob& job, Report& report, Progress& progress)
      : job_(job), report_(report), progress_(progress) {}

  PrepareResult run() {
    check();
    TriangleMesh solid = read();
    const Shells before = findShells(solid);
    result_.volumeBefore = before.volume();
    result_.cavitiesBefore = before.cavities();
    fill(solid);
    // Before cavities are made, whose walls are measured from it.
    roundForFormat(solid, job_.output, report_, progress_);
    result_.keptFaces = isRemade_ ? 0 : solid.triangleCount();
    if (asksVoxels())
      result_.voxel = voxelFor(solid);
    if (job_.offset != 0)
      offset(solid);
    if (job_.wall > 0)
      hollow(solid);
    TriangleMesh outside;
    if (asksDrains()) { // faces of the input come first
      outside.points = solid.points;
      outside.triangles.assign(solid.triangles.begin(),
                               solid.triangles.begin() +
                                   static_cast<std::ptrdiff_t>(3 * result_.keptFaces));
    }
    const std::vector<TriangleMesh> plugs = drill(solid);
    if (!plugs.empty())
      result_.keptFaces = meshChanges(outside, solid).kept;
    const Shells after = findShells(solid);
    result_.volumeAfter = after.volume();
    result_.cavities = after.cavities();
    result_.vertices = solid.points.size();
    result_.triangles = solid.triangleCount();
    result_.units = solid.units;
    write(solid, plugs);
    return std::move(result_);
  }

private:
  bool writesVolume() const { return !writesTriangles(job_.output); }
  bool asksArray() const { return job_.infill && !job_.infill->amount.array.empty(); }
  bool asksDrains() const { return !job_.drains.empty() || job_.drainRadius > 0; }
  bool asksVoxels() const { return job_.offset != 0 || job_.wall > 0 || writesVolume(); }

  static void requireLength(const char* name, double value, bool positive) {
    if (!std::isfinite(value) || (positive && value < 0))
      throw Error(Status::Usage, name, positive ? "must be zero or more" : "must be a number");
  }

  void check() const {
    requireFormat(job_.output, {FormatUse::WriteTriangles, FormatUse::WriteVolume});
    requireSeparateFiles({job_.input}, {job_.output});
    requireWritable(job_.output);
    requireLength("`offset`", job_.offset, false);
    requireLength("`hollow`", job_.wall, true);
    requireLength("`close`", job_.close, true);
    requireLength("`fill_voids`", job_.fillVolume, true);
    requireLength("`simplify`", job_.simplify.value_or(0), true);
    requireLength("`voxel_size`", job_.voxelSize, true);
    if (job_.close > 0 && !(job_.wall > 0))
      throw Error(Status::Usage, "`close`", "is of the cavity that `hollow` makes",
                  "give `hollow` too");
    if (job_.infill)
      checkInfill(*job_.infill);
    if (!std::isfinite(job_.drainRadius) || job_.drainRadius < 0)
      throw Error(Status::Usage, "`drain`", "the radius must be above zero");
    if (job_.offset == 0 && job_.wall == 0 && job_.fillVolume == 0 && !asksDrains())
      throw Error(Status::Usage, "", "nothing was asked for",
                  "give `hollow`, `offset`, `fill_voids` or `drain`");
  }

  void checkInfill(const InfillSettings& infill) const {
    if (!(job_.wall > 0))
      throw Error(Status::Usage, "`infill`", "fills the cavity that `hollow` makes",
                  "give `hollow` too");
    if (!(infill.cell > 0) || !std::isfinite(infill.cell))
      throw Error(Status::Usage, "`cell_size`", "must be a length above zero");
    const InfillAmount& amount = infill.amount;
    const char* name = amount.isDensity ? "`density`" : "`thickness`";
    for (const double number : {amount.low, amount.array.empty() ? amount.low : amount.high})
      if (!(number > 0) || !std::isfinite(number) || (amount.isDensity && number >= 1))
        throw Error(Status::Usage, name,
                    amount.isDensity ? "must be a share of a cell, between 0 and 1"
                                     : "must be a length above zero");
    if (!amount.array.empty() && (job_.isVolume || holdsTriangles(job_.input)))
      throw Error(Status::Usage, name, "an array can be that of tetrahedra alone", "give a number");
  }

  TriangleMesh read() {
    if (job_.isVolume)
      return readVolumeSurface();
    if (!holdsTriangles(job_.input))
      return readTetSurface();
    TriangleMesh mesh;
    {
      StageTimer timer(report_, "read");
      progress_.stage("read");
      mesh = readSoup(job_.input, &result_.input, report_, progress_);
    }
    {
      StageTimer timer(report_, "clean");
      progress_.stage("clean");
      result_.cleaned = cleanInput(mesh, job_.input, job_.clean, report_, progress_);
    }
    mend(mesh);
    return mesh;
  }

  void mend(TriangleMesh& mesh) {
    const MendedSolid mended = mendSolid(mesh, job_.input, job_.maxMemory, report_, progress_);
    isRemade_ = mended.remade;
    result_.repaired = !mended.broken.empty();
    if (result_.repaired && !mended.remade)
      report_.warn("repaired",
                   fmt::format("{}: had {}, which was mended", job_.input, mended.broken));
  }

  TriangleMesh readTetSurface() {
    result_.source = SolidSource::Tets;
    TriangleMesh mesh;
    {
      StageTimer timer(report_, "read");
      progress_.stage("read");
      ReadOptions options;
      options.attributes = asksArray();
      tets_ = readTets(job_.input, options, {}, &result_.input, report_, progress_);
      timer.part("surface");
      mesh = tetSurface(tets_, progress_);
    }
    if (!asksArray())
      tets_ = {};
    mend(mesh);
    return mesh;
  }

  TriangleMesh readVolumeSurface() {
    result_.source = SolidSource::Volume;
    Volume volume;
    {
      StageTimer timer(report_, "read");
      progress_.stage("read");
      volume = readVolumeInput(job_.input, report_, progress_);
    }
    StageTimer timer(report_, "extract");
    progress_.stage("extract");
    ExtractOptions options;
    options.grid = job_.grid;
    options.maxMemory = memoryLeft(job_.maxMemory);
    TriangleMesh mesh = extractSurface(volume, options, progress_);
    const auto units = volume.metadata.find("units");
    mesh.units = units == volume.metadata.end() ? "" : units->second;
    return mesh;
  }

  double voxelFor(const TriangleMesh& solid) {
    if (job_.voxelSize > 0)
      return job_.voxelSize;
    return defaultVoxel(job_, areaOf(solid), result_.volumeBefore, thinnestInfill(),
                        result_.voxelIsCoarse);
  }

  void fill(TriangleMesh& solid) {
    if (job_.fillVolume == 0)
      return;
    const FilledCavities filled = fillCavities(solid, job_.fillVolume);
    result_.filledCavities += filled.cavities;
    result_.filledVolume += filled.volume;
  }

  void offset(TriangleMesh& solid) {
    OffsetOptions options;
    options.distance = job_.offset;
    options.voxel = result_.voxel;
    options.maxMemory = memoryLeft(job_.maxMemory);
    solid = offsetSolid(solid, options, report_, progress_);
    result_.keptFaces = 0;
    fill(solid);
  }

  void hollow(TriangleMesh& solid) {
    CavityOptions options;
    options.wall = job_.wall;
    options.close = job_.close;
    options.voxel = result_.voxel;
    options.maxMemory = memoryLeft(job_.maxMemory);
    std::optional<Infill> infill;
    Volume array; // amounts of the infill, while the cavity is made
    if (job_.infill) {
      infill.emplace(job_.infill->kind, job_.infill->cell);
      options.infill = &*infill;
      options.thickness = thicknessOf(solid, *infill, array);
    }
    Cavity cavity = makeCavity(solid, options, report_, progress_);
    if (job_.infill)
      result_.islands = dropIslands(cavity.surface).cavities;
    if (job_.fillVolume > 0)
      fill(cavity.surface);
    if (cavity.surface.triangles.empty()) {
      report_.warn("no-cavity",
                   fmt::format("walls of {:.6g} fill the solid: there is no cavity", job_.wall));
      return;
    }
    result_.wall = cavity.wall;
    result_.cavityFaces = cavity.surface.triangleCount();
    simplify(cavity.surface);
    appendFaces(solid, cavity.surface);
  }

  // The solid's faces look into the cavity: where these move that way alone no wall gets thinner.
  void simplify(TriangleMesh& cavity) {
    const double voxels =
        job_.simplify.value_or(job_.infill || writesVolume() ? 0 : PrepareJob::kSimplify);
    if (voxels == 0)
      return;
    StageTimer timer(report_, "simplify");
    progress_.stage("simplify");
    SimplifyOptions options;
    options.tolerance = voxels * result_.voxel;
    options.outward = true;
    simplifySurface(cavity, options, progress_);
  }

  // The smallest thickness of the infill; 0 without an infill.
  double thinnestInfill() const {
    if (!job_.infill)
      return 0;
    const InfillAmount& amount = job_.infill->amount;
    const double smaller = amount.array.empty() ? amount.low : std::min(amount.low, amount.high);
    return amount.isDensity ? Infill(job_.infill->kind, job_.infill->cell).thicknessFor(smaller)
                            : smaller;
  }

  ThicknessAt thicknessOf(const TriangleMesh& solid, const Infill& infill, Volume& array) {
    const InfillAmount amount = job_.infill->amount;
    const auto inUnits = [&infill, amount](double number) {
      return amount.isDensity ? infill.thicknessFor(number) : number;
    };
    if (amount.array.empty())
      return [thickness = inUnits(amount.low)](const openvdb::Coord&) { return thickness; };
    FieldOptions wanted;
    wanted.requests.emplace_back().array = amount.array;
    const std::vector<Field> fields = resolveFields(tets_, wanted, report_);
    if (fields.front().kind == FieldKind::Vector)
      throw Error(Status::Usage, amount.isDensity ? "`density`" : "`thickness`",
                  "'" + amount.array + "' has several components",
                  "name one number of it, such as " + amount.array + ":magnitude");
    SampleOptions sampling;
    sampling.maxMemory = memoryLeft(job_.maxMemory);
    sampling.allowEmpty = true;
    sampleFields(tets_, offsetTransform(solid, result_.voxel), fields, sampling, array, report_,
                 progress_);
    const auto& grid = *array.grids().all.front();
    const ValueRange range = fields.front().original;
    const double span = range.high > range.low ? range.high - range.low : 1;
    const auto between = [=](double value) {
      const double share = std::clamp((value - range.low) / span, 0.0, 1.0);
      return inUnits(amount.low + (amount.high - amount.low) * share);
    };
    if (grid.isType<openvdb::FloatGrid>())
      return amountFrom(static_cast<const openvdb::FloatGrid&>(grid), between, range.low);
    return amountFrom(static_cast<const openvdb::Int32Grid&>(grid), between, range.low);
  }

  // Points without a value of the array count as its minimum.
  template <typename GridT, typename Between>
  static ThicknessAt amountFrom(const GridT& grid, const Between& between, double outside) {
    return [&grid, between, outside](const openvdb::Coord& voxel) {
      const openvdb::tree::ValueAccessor<const typename GridT::TreeType, false> values(
          grid.constTree());
      typename GridT::ValueType value;
      return between(values.probeValue(voxel, value) ? static_cast<double>(value) : outside);
    };
  }

  // Returns the plugs.
  std::vector<TriangleMesh> drill(TriangleMesh& solid) {
    if (!asksDrains())
      return {};
    StageTimer timer(report_, "drill");
    progress_.stage("drill");
    std::vector<DrainHole> holes = job_.drains;
    if (job_.drainRadius > 0)
      for (const DrainHole& hole : holesAtLowestPoints(solid, job_.drainRadius))
        holes.push_back(hole);
    if (holes.size() > kMaxDrains)
      throw Error(Status::Invalid, "`drain`",
                  fmt::format("there are {} cavities, too many for a hole each", holes.size()),
                  "fill the small ones by `fill_voids`");
    DrilledHoles drilled = drillHoles(solid, holes, progress_);
    const fs::path output(job_.output);
    for (std::size_t i = 0; i < holes.size(); ++i) {
      PreparedDrain& drain = result_.drains.emplace_back();
      drain.hole = holes[i];
      drain.plugVolume = findShells(drilled.plugs[i]).volume();
      drain.plug.path =
          (output.parent_path() / fmt::format("{}_plug_{}.stl", output.stem().string(), i + 1))
              .string();
      requireSeparateFiles({job_.input}, {job_.output, drain.plug.path});
      requireWritable(drain.plug.path);
    }
    return std::move(drilled.plugs);
  }

  void write(const TriangleMesh& solid, const std::vector<TriangleMesh>& plugs) {
    Volume volume;
    if (writesVolume())
      volume = levelSetOf(solid);
    StageTimer timer(report_, "write");
    progress_.stage("write");
    std::size_t done = 0;
    try {
      for (; done < plugs.size(); ++done)
        writeTriangles(result_.drains[done].plug.path, plugs[done], progress_);
      if (writesVolume())
        writeVolume(job_.output, volume, progress_);
      else
        writeTriangles(job_.output, solid, progress_);
    } catch (...) {
      std::error_code ignored;
      for (std::size_t i = 0; i < done; ++i)
        fs::remove(result_.drains[i].plug.path, ignored);
      throw;
    }
    for (PreparedDrain& drain : result_.drains)
      drain.plug = written(drain.plug.path);
    result_.output = written(job_.output);
  }

  Volume levelSetOf(const TriangleMesh& solid) {
    VoxelizeOptions options;
    options.voxelSize.fill(result_.voxel);
    options.grids = {GridKind::Mask};
    options.maxMemory = memoryLeft(job_.maxMemory);
    Voxelization made = voxelize(solid, {}, options, report_, progress_);
    ShapeOptions shapes;
    shapes.grids = {GridKind::Surface};
    shapes.maxMemory = memoryLeft(job_.maxMemory);
    addShapeGrids(solid, {}, shapes, made, report_, progress_);
    auto& grids = made.volume.grids().all;
    grids.erase(grids.begin()); // the mask
    if (!solid.units.empty())
      made.volume.metadata["units"] = solid.units;
    return std::move(made.volume);
  }

  const PrepareJob& job_;
  Report& report_;
  Progress& progress_;
  TetMesh tets_;          ///< if an array of it is requested
  bool isRemade_ = false; ///< from voxels, so that no face is the input's
  PrepareResult result_;
};

} // namespace

double defaultVoxel(const PrepareJob& job, double area, double volume, double thickness,
                    bool& coarse) {
  double voxel = std::numeric_limits<double>::infinity(), shortest = voxel;
  const auto limit = [&](double length, double voxels) {
    if (length > 0) {
      voxel = std::min(voxel, length / voxels);
      shortest = std::min(shortest, length);
    }
  };
  limit(job.wall, job.infill ? kVoxelsInFilledWall : kVoxelsInWall);
  limit(thickness, kVoxelsInInfill);
  if (job.infill)
    area += kInfillArea * volume / job.infill->cell;
  limit(std::abs(job.offset), kVoxelsInOffset);
  limit(job.close, kVoxelsInClose);
  const double large = std::sqrt(kFacesPerSquare * area / kMaxFaces);
  if (!std::isfinite(voxel)) // only a level set is requested
    return large;
  coarse = large > voxel;
  if (kMinVoxels * large > shortest)
    throw Error(
        Status::Limit, "",
        fmt::format("{:.6g} is short for a solid of {:.6g} square units: its surface in "
                    "voxels of half of that has more than {:.0f} million faces",
                    shortest, area, kMaxFaces / 1e6),
        fmt::format("ask for {:.3g} or more, or say `voxel_size={:.3g}` where that is meant",
                    kMinVoxels * large, shortest / kMinVoxels));
  return std::max(voxel, large);
}

PrepareResult run(const PrepareJob& job, Report& report, Progress& progress) {
  return inArena(job.threads, [&] { return Preparing(job, report, progress).run(); });
}

} // namespace tetvdb
