// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/ShapeSolid.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/fields/DistanceBand.h"
#include "tetvdb/voxelize/BoundaryRaster.h"
#include "tetvdb/voxelize/SoupBoundary.h"
#include "tetvdb/voxelize/SoupChain.h"
#include "tetvdb/voxelize/TreeBuilder.h"
#include "tetvdb/voxelize/TrimFaces.h"

#include <fmt/format.h>
#include <utility>

namespace tetvdb {
namespace {

void requireCoverable(const SolidOptions& how, const SoupBoundary& boundary) {
  if (how.shell > 0 || how.inside != InsideRule::Winding)
    throw Error(Status::Usage, "`grid=coverage`",
                "is computed from the winding number only, not with `shell` or `inside`",
                "leave them out");
  if (!boundary.edges.empty())
    throw Error(
        Status::Invalid, "`grid=coverage`",
        fmt::format("requires closed faces; the mesh has {} open edges", boundary.edges.size()),
        "use `mesher=envelope`, which closes holes by tets, or repair the mesh first");
}

} // namespace

ShapeSolid shapeSolid(const TetMesh& mesh, const GridTransform& transform, Progress& progress) {
  ShapeSolid solid{mesh.points, snapMesh(mesh, transform, progress), {}, {}, 0, {}, {}, 0, false};
  solid.faces = boundaryFaces(solid.mesh, progress);
  solid.rule = FillRule::Positive;
  return solid;
}

ShapeSolid shapeSolid(const std::vector<Vec3d>& points, const SolidFaces& faces) {
  ShapeSolid solid{points, faces.snapped, faces.chain, {}, 0, {}, {}, 0, false};
  solid.rule = FillRule::Positive;
  return solid;
}

ShapeSolid shapeSolid(const TriangleMesh& mesh, const SolidOptions& how, bool covers,
                      const GridTransform& transform, Progress& progress) {
  ShapeSolid solid{mesh.points, snapPoints(mesh.points, transform, progress), {}, {}, 0, {}, {}, 0,
                   false};
  solid.faces = soupFaces(mesh, solid.mesh);
  solid.rule = fillRuleOf(how);
  if (how.closesHoles() || covers) {
    const SoupBoundary boundary = soupBoundary(mesh, progress);
    if (covers)
      requireCoverable(how, boundary);
    if (!boundary.edges.empty()) {
      solid.boundary.emplace(boundaryWinding(boundary.edges, solid.mesh));
      solid.rule.reset();
    }
  }
  return solid;
}

bool trimShape(ShapeSolid& solid, TrimCounts& counts, Report& report, Progress& progress) {
  constexpr const char* kAllFaces = "the level set's absolute values are distances to all faces, "
                                    "including those inside the solid";
  if (!solid.rule) {
    counts.met = countMetFaces(solid.mesh, solid.faces, progress);
    if (counts.met > 0)
      report.warn(
          "untrimmed",
          fmt::format("{} faces cross or touch others; they can only be cut "
                      "in a mesh without open edges whose inside is not determined by flood: {}",
                      counts.met, kAllFaces));
    return false;
  }
  TrimmedFaces trimmed = trimFaces(solid.mesh, solid.faces, *solid.rule, progress);
  counts = trimmed.counts;
  if (!trimmed.complete)
    report.warn("untrimmed",
                fmt::format("too many faces cross one another to be cut: {}", kAllFaces));
  if (trimmed.changed) {
    solid.mesh = std::move(trimmed.mesh);
    solid.faces = std::move(trimmed.faces);
  }
  return trimmed.changed;
}

double shapeBytes(const ShapeSolid& solid, const ShapeOptions& options) {
  const bool covers = contains(options.grids, GridKind::Coverage);
  const auto bands = static_cast<double>(options.grids.size()) - (covers ? 1 : 0);
  double leaves = covers ? static_cast<double>(estimateBoundaryLeaves(solid.mesh, solid.faces)) : 0;
  const double trimming = bands > 0 && solid.shell == 0 ? 200 : 0; // bytes per face
  if (bands > 0)
    leaves += (solid.filled ? bands + 1 : bands) *
              estimateBandLeaves(solid.mesh, solid.faces,
                                 options.halfWidth + solid.shell + solid.thickness);
  return 48.0 * static_cast<double>(solid.mesh.pointCount) +
         (40.0 + trimming) * static_cast<double>(solid.faces.faces.size()) +
         leaves * static_cast<double>(leafBytes(GridKind::Density)) +
         (leaves / 128 + 64) * static_cast<double>(kLowerNodeBytes);
}

void warnOfOverlap(const CoverageSum& sum, Report& report) {
  if (sum.overlapVoxels > 0)
    report.warn("overlap",
                fmt::format("components of the mesh overlap: {} voxels are filled more than "
                            "once; {:.6g} voxels' volume is counted once only",
                            sum.overlapVoxels, sum.overlap));
}

} // namespace tetvdb
