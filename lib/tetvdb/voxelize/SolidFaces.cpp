// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/SolidFaces.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/FillHoles.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/voxelize/SoupChain.h"

#include <cmath>
#include <fmt/format.h>
#include <utility>
#include <xxhash.h>

namespace tetvdb {
namespace {

std::string whyEmpty(const SoupBoundary& boundary, const SolidOptions& solid) {
  if (solid.shell > 0)
    return "no voxel centre lies in the shell";
  if (boundary.edges.empty())
    return "no voxel centre lies inside the mesh";
  if (solid.inside == InsideRule::Flood)
    return "the outside reaches every voxel: the mesh leaks at this voxel size";
  return fmt::format("the mesh is open ({} open edges) and holds no inside: its winding number is "
                     "above 0.5 at no voxel centre",
                     boundary.edges.size());
}

// An open mesh whose inside is very small compared with its faces is probably a sheet.
void warnIfThin(std::uint64_t inside, double surface, Report& report) {
  if (static_cast<double>(inside) < 0.02 * surface)
    report.warn("nearly-empty",
                fmt::format("only {} voxels are inside faces that pass through about {:.0f}: the "
                            "mesh is rather a sheet, which `shell=T` gives a thickness",
                            inside, surface));
}

// A plate of thickness t, volume V and area A has t = 2 V / A, but for its rim. One along the axes
// has a layer of voxel centres inside if voxels are no larger than t.
double meanThickness(const TriangleMesh& mesh) {
  const double area = areaOf(mesh);
  return area > 0 ? 2 * std::abs(volumeOf(mesh)) / area : 0;
}

std::string emptyAdvice(const TriangleMesh& mesh, const SoupBoundary& boundary,
                        const SolidOptions& solid) {
  const double thickness = boundary.edges.empty() ? meanThickness(mesh) : 0;
  if (solid.shell == 0 && thickness > 0)
    return fmt::format("use smaller voxels, of at most {:.3g}, the mean thickness of the mesh; or "
                       "`allow_empty` to write an empty grid",
                       thickness);
  if (solid.shell > 0 || boundary.edges.empty())
    return "use smaller voxels, or `allow_empty` to write an empty grid";
  if (solid.inside == InsideRule::Flood)
    return "use `inside=winding`, which closes holes, or larger voxels";
  return "give the sheet a thickness with `shell=T`, or use smaller voxels";
}

} // namespace

void checkSolidOptions(const TriangleMesh& mesh, const SolidOptions& solid,
                       const VoxelizeOptions& options) {
  checkGridKinds(options.grids, {GridMaker::Occupancy});
  if (options.rule != VoxelRule::Centre && (solid.shell > 0 || solid.inside == InsideRule::Flood))
    throw Error(Status::Usage, "`rule`", "any and all do not go with `shell` or `inside=flood`",
                "leave one of them out");
  if (!(solid.shell >= 0) || !std::isfinite(solid.shell))
    throw Error(Status::Usage, "`shell`", fmt::format("{} is not a thickness", solid.shell));
  if (solid.shell > 0 && solid.side != ShellSide::Both && solid.inside == InsideRule::Flood)
    throw Error(Status::Usage, "`shell_side`", "does not go with `inside=flood`",
                "leave one of them out");
  if (mesh.triangleCount() >= 0xFFFFFFFFu)
    throw Error(Status::Limit, "", "the mesh has 2^32 triangles or more", "split it in parts");
  if (mesh.triangles.empty())
    throw Error(Status::Invalid, "", "the mesh has no triangles");
}

SolidFaces solidFaces(const TriangleMesh& mesh, const SolidOptions& solid,
                      const GridTransform& transform, StageTimer& timer, Progress& progress) {
  SolidFaces result;
  timer.part("snap");
  result.snapped = snapPoints(mesh.points, transform, progress);
  result.chain = soupFaces(mesh, result.snapped);
  result.counts.boundaryFaces = result.chain.faces.size();
  result.rule = fillRuleOf(solid).value_or(FillRule::Positive);

  const bool fills = solid.shell == 0;
  SoupBoundary& boundary = result.boundary;
  if (fills || solid.side != ShellSide::Both) {
    timer.part("boundary");
    boundary = soupBoundary(mesh, progress);
    result.counts.openEdges = boundary.edges.size();
  }
  if (fills && result.rule == FillRule::Odd && boundary.oddEdges > 0)
    throw Error(Status::Invalid, "",
                fmt::format("{} edges have an odd number of faces, so that parity has no meaning",
                            boundary.oddEdges),
                "use `inside=winding`, which closes holes");
  if (fills && solid.inside != InsideRule::Flood && result.rule != FillRule::Odd &&
      !boundary.edges.empty())
    result.holes.emplace(fillHoles(boundaryEdges(boundary.edges, result.snapped)));
  return result;
}

SolidFaces solidFaces(const TetMesh& mesh, const GridTransform& transform, StageTimer& timer,
                      Progress& progress) {
  SolidFaces result;
  timer.part("snap");
  result.snapped = snapMesh(mesh, transform, progress);
  timer.part("boundary");
  result.chain = boundaryFaces(result.snapped, progress);
  result.counts.flipped = result.chain.flipped;
  result.counts.dropped = result.chain.dropped;
  result.counts.boundaryFaces = result.chain.faces.size();
  return result;
}

void checkSolid(const TriangleMesh& mesh, const SoupBoundary& boundary, const SolidOptions& solid,
                std::uint64_t activeVoxels, double surfaceVoxels, const VoxelizeOptions& options,
                Report& report) {
  if (!options.allowEmpty && activeVoxels == 0)
    throw Error(Status::Invalid, "", whyEmpty(boundary, solid), emptyAdvice(mesh, boundary, solid));
  if (solid.shell == 0 && !boundary.edges.empty())
    warnIfThin(activeVoxels, surfaceVoxels, report);
}

std::string markOf(const SolidFaces& faces) {
  XXH128_hash_t mark{static_cast<std::uint64_t>(faces.rule), faces.chain.faces.size()};
  const auto add = [&](const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
                       std::int32_t weight) {
    const double numbers[12] = {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, double(weight), 0, 0};
    const XXH128_hash_t own = XXH3_128bits_withSeed(numbers, sizeof numbers, mark.low64);
    mark = XXH3_128bits_withSeed(&own, sizeof own, mark.high64);
  };
  for (const BoundaryFace& f : faces.chain.faces)
    add(faces.snapped.points[f.a], faces.snapped.points[f.b], faces.snapped.points[f.c], f.weight);
  for (std::size_t i = 0; faces.holes && i < faces.holes->triangleCount(); ++i) {
    const FillTriangle& t = faces.holes->triangle(i);
    add(t.a, t.b, t.c, t.weight);
  }
  return fmt::format("{:016x}{:016x}", mark.high64, mark.low64);
}

double bytesOf(const SolidFaces& faces) {
  return 24.0 * static_cast<double>(faces.snapped.pointCount) +
         64.0 * static_cast<double>(faces.chain.faces.size());
}

} // namespace tetvdb
