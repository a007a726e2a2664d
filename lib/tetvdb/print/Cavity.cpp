// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/Cavity.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/print/GuardedSurface.h"
#include "tetvdb/print/OffsetLevelSet.h"
#include "tetvdb/print/SolidDistances.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <openvdb/tools/Composite.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kMinVoxels = 2;        // of a wall
constexpr double kBytesPerSquare = 300; // of all steps together, per square voxel of the surface

// The largest displacement of a point of the mesh by rounding to 32-bit floats.
double floatRounding(const TriangleMesh& mesh) {
  double far = 0;
  for (const std::uint32_t v : mesh.triangles)
    for (const double x : mesh.points[v])
      far = std::max(far, std::abs(x));
  return far * 0x1p-24 * std::sqrt(3.0);
}

class CavityMaker {
public:
  CavityMaker(const TriangleMesh& solid, const CavityOptions& options, Report& report,
              Progress& progress)
      : solid_(solid), options_(options), report_(report), progress_(progress),
        rounding_(floatRounding(solid)) {}

  Cavity run() {
    check();
    transform_ = offsetTransform(solid_, options_.voxel);
    const SolidDistances distances(solid_, transform_, options_.maxMemory, report_, progress_);
    openvdb::FloatGrid::Ptr limit;
    if (options_.close > 0) {
      const Layer core = layerAt(distances, options_.wall + options_.close);
      GuardedSurface surface = extract(core.shape, nullptr, core);
      if (surface.mesh.triangles.empty())
        return {};
      limit = around(surface.mesh);
    }
    const Layer layer = layerAt(distances, options_.wall);
    openvdb::FloatGrid::Ptr shape = layer.shape;
    if (limit)
      openvdb::tools::csgIntersection(*shape, *limit->deepCopy(), false);
    if (options_.infill != nullptr)
      limit = withInfill(*shape, limit);
    GuardedSurface surface = extract(shape, limit.get(), layer);
    for (std::size_t i = 0; i < surface.mesh.triangles.size(); i += 3)
      std::swap(surface.mesh.triangles[i + 1], surface.mesh.triangles[i + 2]);
    return {std::move(surface.mesh), surface.distance};
  }

private:
  // The points farther than a distance inside the solid.
  struct Layer {
    openvdb::FloatGrid::Ptr squared, shape;
    double distance = 0;
  };

  void check() const {
    const double fewest = kMinVoxels * options_.voxel;
    if (!(options_.voxel > 0) || !std::isfinite(options_.voxel))
      throw Error(Status::Usage, "`voxel_size`", "must be a length above zero");
    if (!(options_.wall >= fewest) || !std::isfinite(options_.wall))
      throw Error(Status::Usage, "`hollow`",
                  fmt::format("a wall of {:.6g} is less than two voxels of {:.6g}", options_.wall,
                              options_.voxel),
                  fmt::format("use `voxel_size={:.3g}` or smaller", options_.wall / kMinVoxels));
    if (options_.close != 0 && (!(options_.close >= fewest) || !std::isfinite(options_.close)))
      throw Error(Status::Usage, "`close`",
                  fmt::format("a radius of {:.6g} is less than two voxels of {:.6g}",
                              options_.close, options_.voxel),
                  "use a larger radius, or a smaller `voxel_size`");
    requireMemory(solid_, options_.voxel, kBytesPerSquare, options_.maxMemory);
  }

  Guard guardOf(const Layer& layer) const {
    return {*layer.squared, layer.distance, options_.voxel, rounding_};
  }

  Layer layerAt(const SolidDistances& distances, double distance) {
    StageTimer timer(report_, "distance");
    progress_.stage("distance");
    Layer layer;
    layer.distance = distance;
    const auto nothing = openvdb::FloatGrid::create();
    const double from = Guard{*nothing, distance, options_.voxel, rounding_}.insideFrom();
    const double reach = kOffsetBand * options_.voxel;
    layer.squared = distances.between(SolidSide::Inside, from - reach, from + reach, progress_);
    layer.shape = offsetLevelSet(*layer.squared, from, OffsetKept::Farther, distances.transform());
    return layer;
  }

  GuardedSurface extract(const openvdb::FloatGrid::Ptr& shape, const openvdb::FloatGrid* limit,
                         const Layer& layer) {
    StageTimer timer(report_, "extract");
    progress_.stage("extract");
    return guardedSurface(shape, limit, guardOf(layer), progress_);
  }

  // Subtracts the infill from `shape`; returns its limit combined with `limit`.
  openvdb::FloatGrid::Ptr withInfill(openvdb::FloatGrid& shape,
                                     const openvdb::FloatGrid::Ptr& limit) {
    StageTimer timer(report_, "infill");
    progress_.stage("infill");
    openvdb::FloatGrid::Ptr infill =
        infillLevelSet(shape, *options_.infill, options_.thickness, progress_);
    openvdb::tools::csgIntersection(shape, *infill->deepCopy(), false);
    if (limit)
      openvdb::tools::csgIntersection(*infill, *limit, false);
    return infill;
  }

  // The points within the radius of `core`.
  openvdb::FloatGrid::Ptr around(const TriangleMesh& core) {
    const SolidDistances distances(core, transform_, options_.maxMemory, report_, progress_);
    StageTimer timer(report_, "distance");
    progress_.stage("distance");
    const double reach = kOffsetBand * options_.voxel;
    const auto squared = distances.between(SolidSide::Outside, options_.close - reach,
                                           options_.close + reach, progress_);
    return offsetLevelSet(*squared, options_.close, OffsetKept::Nearer, distances.transform());
  }

  const TriangleMesh& solid_;
  const CavityOptions& options_;
  Report& report_;
  Progress& progress_;
  const double rounding_;
  GridTransform transform_;
};

} // namespace

Cavity makeCavity(const TriangleMesh& solid, const CavityOptions& options, Report& report,
                  Progress& progress) {
  return CavityMaker(solid, options, report, progress).run();
}

} // namespace tetvdb
