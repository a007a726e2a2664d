// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/WeldBoundary.h"

#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/surface/WeldPoints.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

namespace tetvdb {
namespace {

// Fills points, `first` and `extent`, and says which of them every point of the mesh is.
std::vector<std::uint32_t> weldUsedPoints(const SnappedMesh& mesh, const Boundary& boundary,
                                          WeldedFaces& welded, Progress& progress) {
  std::vector<std::atomic<bool>> isUsed(mesh.pointCount);
  forEachIndex(boundary.faces.size(), [&](std::size_t i) {
    const BoundaryFace& f = boundary.faces[i];
    for (const std::uint32_t corner : {f.a, f.b, f.c})
      isUsed[corner].store(true, std::memory_order_relaxed);
  });
  std::vector<std::uint32_t> used;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  LatticePoint& first = welded.first;
  first = {kFar, kFar, kFar};
  for (std::uint32_t i = 0; i < mesh.pointCount; ++i)
    if (isUsed[i].load(std::memory_order_relaxed)) {
      used.push_back(i);
      const LatticePoint& p = mesh.points[i];
      first = {std::min(first.x, p.x), std::min(first.y, p.y), std::min(first.z, p.z)};
    }
  std::vector<Vec3d> points(used.size());
  forEachIndex(used.size(), [&](std::size_t i) {
    const LatticePoint& p = mesh.points[used[i]];
    points[i] = {p.x - first.x, p.y - first.y, p.z - first.z};
  });
  const std::vector<std::uint32_t> becomes = weldPoints(points, 0, progress);
  std::vector<std::uint32_t> number(mesh.pointCount);
  welded.points.reserve(used.size());
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (becomes[i] == i) {
      const Vec3d& p = points[i];
      number[used[i]] = static_cast<std::uint32_t>(welded.points.size());
      welded.points.push_back(p);
      welded.extent = std::max({welded.extent, p[0], p[1], p[2]});
    } else {
      number[used[i]] = number[used[becomes[i]]]; // an earlier one
    }
  }
  return number;
}

} // namespace

WeldedFaces weldFaces(const SnappedMesh& mesh, const Boundary& boundary, Progress& progress) {
  progress.check();
  WeldedFaces welded;
  const std::vector<std::uint32_t> number = weldUsedPoints(mesh, boundary, welded, progress);
  progress.check();
  const std::size_t count = boundary.faces.size();
  std::vector<WeldedFace>& all = welded.faces;
  all.resize(count);
  forEachIndex(count, [&](std::size_t i) {
    const BoundaryFace& f = boundary.faces[i];
    all[i] = ascendingFace(welded.points, {number[f.a], number[f.b], number[f.c]}, f.weight);
    const std::array<std::uint32_t, 3>& c = all[i].corners;
    if (c[0] == c[1] || c[1] == c[2] ||
        areCollinear(welded.points[c[0]], welded.points[c[1]], welded.points[c[2]]))
      all[i].weight = 0;
  });
  const auto solid =
      std::remove_if(all.begin(), all.end(), [](const WeldedFace& f) { return f.weight == 0; });
  welded.flat = static_cast<std::size_t>(all.end() - solid);
  all.erase(solid, all.end());
  return welded;
}

} // namespace tetvdb
