// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CleanTriangles.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/surface/CanonicalOrder.h"
#include "tetvdb/surface/CloseComponents.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/DecideFaces.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/FaceSides.h"
#include "tetvdb/surface/WeldBoundary.h"
#include "tetvdb/surface/WeldPoints.h"

#include <cmath>
#include <optional>
#include <utility>

namespace tetvdb {
namespace {

// Relative to the area to the power of 1.5; a ball has 0.094.
constexpr double kNothing = 1e-5;

// Keeps the faces for which keep(corners, face) holds; returns the number of removed faces.
template <typename Keep>
std::size_t keepFaces(TriangleMesh& mesh, const Keep& keep) {
  std::vector<std::uint32_t>& corners = mesh.triangles;
  const std::size_t faces = mesh.triangleCount();
  std::size_t kept = 0;
  for (std::size_t face = 0; face < faces; ++face) {
    if (!keep(&corners[3 * face], face))
      continue;
    for (std::size_t k = 0; k < 3; ++k)
      corners[3 * kept + k] = corners[3 * face + k];
    ++kept;
  }
  corners.resize(3 * kept);
  return faces - kept;
}

// Replaces points as given by `becomes`; removes faces with a repeated point.
void renumber(TriangleMesh& mesh, const std::vector<std::uint32_t>& becomes, CleanCounts& counts) {
  const std::size_t welded =
      countWhere(becomes.size(), [&](std::size_t point) { return becomes[point] != point; });
  if (welded > 0)
    forEachIndex(mesh.triangles.size(),
                 [&](std::size_t i) { mesh.triangles[i] = becomes[mesh.triangles[i]]; });
  counts.weldedPoints += welded;
  const auto isWhole = [](const std::uint32_t* v) {
    return v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
  };
  if (countWhere(mesh.triangleCount(),
                 [&](std::size_t face) { return !isWhole(&mesh.triangles[3 * face]); }) > 0)
    counts.degenerateFaces +=
        keepFaces(mesh, [&](const std::uint32_t* v, std::size_t) { return isWhole(v); });
  // Merged points have no faces any more; they are not counted twice.
  counts.unreferencedPoints += dropUnusedPoints(mesh) - welded;
}

// Whether the signed volumes cancel, as for a closed mesh with a copy of opposite orientation.
bool enclosesNothing(const TriangleMesh& mesh, const EdgeTable& edges) {
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
    if (edges.sides(edge).size() % 2 != 0)
      return false;
  double volume = 0, area = 0;
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face) {
    const std::uint32_t* v = &mesh.triangles[3 * face];
    const Vec3d a = minus(mesh.points[v[0]], mesh.points[0]);
    const Vec3d b = minus(mesh.points[v[1]], mesh.points[0]);
    const Vec3d c = minus(mesh.points[v[2]], mesh.points[0]);
    volume += dot(a, cross(b, c)) / 6;
    area += length(cross(minus(b, a), minus(c, a))) / 2;
  }
  return std::abs(volume) < kNothing * std::pow(area, 1.5);
}

// Merges close points of the boundary. Returns whether any were merged.
bool weldNearPoints(TriangleMesh& mesh, const EdgeTable& edges, WeldCandidates candidates,
                    CleanCounts& counts, Progress& progress) {
  const BoundaryWeld weld = weldBoundary(mesh, edges, candidates, progress);
  if (weld.becomes.empty())
    return false;
  counts.weldDistance = weld.distance;
  renumber(mesh, weld.becomes, counts);
  return true;
}

// Whether every edge has two faces in opposite directions, and all shells are oriented
// outward.
bool isPlainSolid(const TriangleMesh& mesh, const EdgeTable& edges, Progress& progress) {
  if (countWhere(edges.edgeCount(), [&](std::size_t edge) {
        return !edges.isManifold(static_cast<std::uint32_t>(edge));
      }) > 0)
    return false;
  FaceSides sides(mesh, edges, progress);
  sides.alignPatches({});
  return sides.allShellsLookOutward();
}

void closeHoles(TriangleMesh& mesh, CleanCounts& counts, Progress& progress) {
  const ClosedComponents closed = closeComponents(mesh, progress);
  counts.closedHoles = closed.holes.size();
  counts.closingFaces = closed.faces;
  counts.open = countSheets(mesh, progress);
}

void apply(const FaceDecision& decision, const std::vector<std::uint32_t>& faceWas,
           TriangleMesh& mesh, CleanCounts& counts) {
  std::vector<std::uint8_t> dropped(faceWas.size(), 0);
  for (std::size_t i = 0; i < faceWas.size(); ++i) {
    const std::size_t face = faceWas[i];
    if (!decision.dropped.empty() && decision.dropped[i]) {
      dropped[face] = 1;
    } else if (!decision.turned.empty() && decision.turned[i]) {
      std::swap(mesh.triangles[3 * face + 1], mesh.triangles[3 * face + 2]);
      ++counts.flippedFaces;
    }
  }
  const std::size_t gone =
      keepFaces(mesh, [&](const std::uint32_t*, std::size_t face) { return dropped[face] == 0; });
  counts.innerFaces = decision.innerFaces;
  counts.duplicateFaces = gone - decision.innerFaces;
  counts.unreferencedPoints += dropUnusedPoints(mesh);
  counts.flippedParts = decision.turnedShells;
  counts.insideOut = decision.insideOut;
  counts.doubtful = decision.doubtful;
  counts.fileVolume = decision.fileVolume;
  counts.turnedVolume = decision.turnedVolume;
}

} // namespace

CleanCounts cleanTriangles(TriangleMesh& mesh, const CleanOptions& options, Progress& progress) {
  if (options.weldDistance && !(*options.weldDistance >= 0))
    throw Error(Status::Usage, "weld distance", "not a length", "give 0 or more, in input units");
  checkMesh(mesh);
  CleanCounts counts;
  counts.weldDistance = options.weldDistance.value_or(0);
  renumber(mesh, weldPoints(mesh.points, counts.weldDistance, progress), counts);
  progress.update(0.3);
  std::optional<EdgeTable> edges(mesh);
  if (!options.weldDistance &&
      weldNearPoints(mesh, *edges, WeldCandidates::BoundaryPoints, counts, progress))
    edges.emplace(mesh);
  progress.update(0.5);
  if ((!options.duplicates && !options.orient && !options.closeHoles) ||
      isPlainSolid(mesh, *edges, progress)) {
    progress.update(1);
    return counts;
  }
  if (options.duplicates || options.orient) {
    if (!options.weldDistance && options.duplicates && enclosesNothing(mesh, *edges))
      weldNearPoints(mesh, *edges, WeldCandidates::AllPoints, counts, progress);
    edges.reset();
    const CanonicalOrder canonical = canonicalOrder(mesh);
    progress.update(0.6);
    apply(decideFaces(canonical.mesh, options, progress), canonical.faceWas, mesh, counts);
  }
  if (options.closeHoles)
    closeHoles(mesh, counts, progress);
  progress.update(1);
  return counts;
}

} // namespace tetvdb
