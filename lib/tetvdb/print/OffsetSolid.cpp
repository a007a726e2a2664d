// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/OffsetSolid.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/print/OffsetLevelSet.h"
#include "tetvdb/print/SolidDistances.h"
#include "tetvdb/surface/MarchingCubes.h"
#include "tetvdb/surface/TriangleScene.h"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr double kMinOffsetVoxels = 2;
constexpr double kBytesPerOffsetSquare =
    500; // of all steps together, per square voxel of the surface

// Samples of an offset solid, whose surface passes between two voxels at the distance.
class OffsetSamples : public SolidSamples {
public:
  OffsetSamples(std::unique_ptr<SolidSamples> shape, const TriangleScene& scene, double distance,
                bool grows)
      : shape_(std::move(shape)), scene_(scene), distance_(distance), grows_(grows) {
    transform = shape_->transform;
  }

  std::vector<Vec3i> blocks(Progress& progress) const override { return shape_->blocks(progress); }
  void load(const Vec3i& block, BlockSamples& samples) const override {
    shape_->load(block, samples);
  }
  bool hasHeights() const override { return true; }

  // Regula falsi with halved weights (Dowell and Jarratt's Illinois method), from points on both
  // sides.
  double passage(const Vec3i& voxel, std::size_t axis, bool startInside) const override {
    constexpr int kSteps = 16;
    constexpr double kNear = 1e-6; // voxels
    const double near = kNear * transform.voxelSize[axis];
    double low = 0, high = 1;
    double below = insideBy(voxel, axis, low), above = insideBy(voxel, axis, high);
    if ((below > 0) != startInside || (above > 0) == startInside)
      return std::numeric_limits<double>::quiet_NaN(); // within rounding of a voxel's centre
    double t = 0.5;
    for (int step = 0, side = 0; step < kSteps; ++step) {
      t = (low * above - high * below) / (above - below);
      const double value = insideBy(voxel, axis, t);
      if (std::abs(value) < near)
        break;
      if ((value > 0) == startInside) {
        low = t;
        below = value;
        above *= side < 0 ? 0.5 : 1;
        side = -1;
      } else {
        high = t;
        above = value;
        below *= side > 0 ? 0.5 : 1;
        side = 1;
      }
    }
    return t;
  }

private:
  // World units, above 0 inside the offset solid.
  double insideBy(const Vec3i& voxel, std::size_t axis, double t) const {
    Vec3d p;
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = transform.origin[k] + transform.voxelSize[k] * (voxel[k] + (k == axis ? t : 0));
    const double away = scene_.closest(p).distance;
    return grows_ ? distance_ - away : away - distance_;
  }

  std::unique_ptr<SolidSamples> shape_;
  const TriangleScene& scene_;
  const double distance_;
  const bool grows_;
};

// The offset surface is perpendicular to the direction to the nearest point of the solid.
std::vector<ShapeContact> contactsOf(const TriangleMesh& offset, const TriangleScene& scene,
                                     double distance) {
  std::vector<ShapeContact> contacts(offset.points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, contacts.size()), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const Vec3d& p = offset.points[i];
      const TriangleScene::Closest closest = scene.closest(p);
      if (!(closest.distance > 0))
        continue;
      const Vec3d away = times(minus(p, closest.point), 1 / closest.distance);
      const double sign = distance > 0 ? 1 : -1;
      contacts[i].point = plus(closest.point, times(away, std::abs(distance)));
      for (std::size_t k = 0; k < 3; ++k)
        contacts[i].normal[k] = static_cast<float>(sign * away[k]);
    }
  });
  return contacts;
}

void check(const TriangleMesh& solid, const OffsetOptions& options) {
  if (!(options.voxel > 0) || !std::isfinite(options.voxel))
    throw Error(Status::Usage, "`voxel_size`", "must be a length above zero");
  if (!std::isfinite(options.distance) ||
      !(std::abs(options.distance) >= kMinOffsetVoxels * options.voxel))
    throw Error(
        Status::Usage, "`offset`",
        fmt::format("{:.6g} is less than two voxels of {:.6g}", options.distance, options.voxel),
        fmt::format("use `voxel_size={:.3g}` or smaller",
                    std::abs(options.distance) / kMinOffsetVoxels));
  requireMemory(solid, options.voxel, kBytesPerOffsetSquare, options.maxMemory);
}

} // namespace

TriangleMesh offsetSolid(const TriangleMesh& solid, const OffsetOptions& options, Report& report,
                         Progress& progress) {
  check(solid, options);
  const SolidDistances distances(solid, offsetTransform(solid, options.voxel), options.maxMemory,
                                 report, progress);
  const bool grows = options.distance > 0;
  const double distance = std::abs(options.distance), reach = kOffsetBand * options.voxel;
  const auto grids = std::make_shared<GridSet>();
  {
    StageTimer timer(report, "distance");
    progress.stage("distance");
    const auto squared = distances.between(grows ? SolidSide::Outside : SolidSide::Inside,
                                           distance - reach, distance + reach, progress);
    grids->all = {offsetLevelSet(*squared, distance,
                                 grows ? OffsetKept::Nearer : OffsetKept::Farther,
                                 distances.transform())};
  }
  StageTimer timer(report, "extract");
  progress.stage("extract");
  const Volume volume(grids);
  MarchedCubes marched;
  const OffsetSamples samples(solidSamples(volume, ""), distances.scene(), distance, grows);
  TriangleMesh surface = marchCubes(samples, {}, progress, &marched);
  if (surface.triangles.empty())
    throw Error(Status::Invalid, "",
                fmt::format("nothing of the solid is left once it shrinks by {:.6g}", distance),
                "shrink it by less");
  marched.contacts = contactsOf(surface, distances.scene(), options.distance);
  sharpenCreases(surface, marched.contacts, marched.cubes, distances.transform(), progress);
  surface.units = solid.units;
  return surface;
}

} // namespace tetvdb
