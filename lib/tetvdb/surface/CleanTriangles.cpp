// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CleanTriangles.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/surface/DuplicateFaces.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/FaceSides.h"
#include "tetvdb/surface/WeldPoints.h"

#include <optional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

// Keeps the faces for which keep(corners, face) holds; returns how many went.
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

// Drops points that no face uses; returns how many.
std::size_t dropUnreferencedPoints(TriangleMesh& mesh) {
  constexpr std::uint32_t kUsed = 1;
  std::vector<std::uint32_t> number(mesh.points.size(), 0);
  for (const std::uint32_t v : mesh.triangles)
    number[v] = kUsed;
  std::uint32_t kept = 0;
  for (std::size_t point = 0; point < mesh.points.size(); ++point) {
    if (number[point] != kUsed)
      continue;
    mesh.points[kept] = mesh.points[point];
    number[point] = kept++;
  }
  const std::size_t dropped = mesh.points.size() - kept;
  if (dropped == 0)
    return 0;
  mesh.points.resize(kept);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), 1 << 16),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i)
                        mesh.triangles[i] = number[mesh.triangles[i]];
                    });
  return dropped;
}

void weld(TriangleMesh& mesh, double distance, CleanCounts& counts, Progress& progress) {
  const std::vector<std::uint32_t> becomes = weldPoints(mesh.points, distance, progress);
  for (std::size_t point = 0; point < becomes.size(); ++point)
    counts.weldedPoints += becomes[point] != point;
  if (counts.weldedPoints > 0)
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), 1 << 16),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        for (std::size_t i = range.begin(); i != range.end(); ++i)
                          mesh.triangles[i] = becomes[mesh.triangles[i]];
                      });
  counts.degenerateFaces = keepFaces(mesh, [](const std::uint32_t* v, std::size_t) {
    return v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
  });
  // Points that became another are without faces now, and are not counted twice.
  counts.unreferencedPoints = dropUnreferencedPoints(mesh) - counts.weldedPoints;
}

// Whether there were any. `withoutSide`: by face that stays, 1 where its copies left its side open.
bool dropDuplicates(TriangleMesh& mesh, const EdgeTable& edges, CleanCounts& counts,
                    std::vector<std::uint8_t>& withoutSide, Progress& progress) {
  const DuplicateGroups groups = findDuplicates(edges);
  if (groups.count() == 0)
    return false;
  const auto fates = resolveDuplicates(mesh.triangles, mesh.points.size(), groups, progress);
  for (const FaceFate fate : fates)
    if (fate != FaceFate::Goes)
      withoutSide.push_back(fate == FaceFate::StaysWithoutSide);
  counts.duplicateFaces = keepFaces(
      mesh, [&](const std::uint32_t*, std::size_t face) { return fates[face] != FaceFate::Goes; });
  counts.unreferencedPoints += dropUnreferencedPoints(mesh);
  return true;
}

void turnFaces(TriangleMesh& mesh, const FaceSides& sides, CleanCounts& counts) {
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face)
    if (sides.turned()[face]) {
      std::swap(mesh.triangles[3 * face + 1], mesh.triangles[3 * face + 2]);
      ++counts.flippedFaces;
    }
  counts.flippedParts = sides.turnedShells();
  counts.insideOut = sides.insideOut();
}

} // namespace

CleanCounts cleanTriangles(TriangleMesh& mesh, const CleanOptions& options, Progress& progress) {
  if (!(options.weldDistance >= 0))
    throw Error(Status::Usage, "weld distance", "not a length", "give 0 or more, in input units");
  CleanCounts counts;
  weld(mesh, options.weldDistance, counts, progress);
  progress.update(0.3);
  std::optional<EdgeTable> edges;
  if (options.duplicates || options.orient)
    edges.emplace(mesh);
  progress.update(0.5);
  std::vector<std::uint8_t> withoutSide;
  if (options.duplicates && dropDuplicates(mesh, *edges, counts, withoutSide, progress) &&
      options.orient)
    edges.emplace(mesh);
  if (options.orient) {
    FaceSides sides(mesh, *edges, progress);
    sides.alignPatches(withoutSide);
    progress.update(0.7);
    sides.alignByVisibility(progress);
    sides.turnShells(progress);
    turnFaces(mesh, sides, counts);
  }
  progress.update(1);
  return counts;
}

} // namespace tetvdb
