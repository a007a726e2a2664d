// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/WeldBoundary.h"

#include "tetvdb/core/MixBits.h"
#include "tetvdb/geometry/Orientation.h"

#include <algorithm>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <utility>

namespace tetvdb {
namespace {

// Fills points, `first` and `extent`, and says which of them every point of the mesh is.
std::vector<std::uint32_t> weldPoints(const SnappedMesh& mesh, const Boundary& boundary,
                                      WeldedFaces& welded) {
  constexpr std::uint32_t kNone = 0xFFFFFFFFu;
  std::vector<std::uint32_t> number(mesh.pointCount, kNone);
  constexpr double kFar = std::numeric_limits<double>::infinity();
  LatticePoint& first = welded.first;
  first = {kFar, kFar, kFar};
  std::size_t used = 0;
  for (const BoundaryFace& f : boundary.faces)
    for (const std::uint32_t i : {f.a, f.b, f.c})
      if (number[i] == kNone) {
        number[i] = 0;
        ++used;
        const LatticePoint& p = mesh.points[i];
        first = {std::min(first.x, p.x), std::min(first.y, p.y), std::min(first.z, p.z)};
      }
  std::size_t size = 64;
  while (size < 2 * used)
    size *= 2;
  std::vector<std::uint32_t> table(size, kNone); // open addressing, linear probing
  welded.points.reserve(used);
  for (std::uint32_t i = 0; i < mesh.pointCount; ++i) {
    if (number[i] == kNone)
      continue;
    const LatticePoint& p = mesh.points[i];
    const Vec3d at{p.x - first.x, p.y - first.y, p.z - first.z};
    std::size_t slot = hashOfPoint(at) & (size - 1);
    while (table[slot] != kNone && welded.points[table[slot]] != at)
      slot = (slot + 1) & (size - 1);
    if (table[slot] == kNone) {
      table[slot] = static_cast<std::uint32_t>(welded.points.size());
      welded.points.push_back(at);
      welded.extent = std::max({welded.extent, at[0], at[1], at[2]});
    }
    number[i] = table[slot];
  }
  return number;
}

} // namespace

WeldedFaces weldFaces(const SnappedMesh& mesh, const Boundary& boundary, Progress& progress) {
  progress.check();
  WeldedFaces welded;
  const std::vector<std::uint32_t> number = weldPoints(mesh, boundary, welded);
  progress.check();
  const std::size_t count = boundary.faces.size();
  std::vector<WeldedFace>& all = welded.faces;
  all.resize(count);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const BoundaryFace& f = boundary.faces[i];
      all[i] = ascendingFace(welded.points, {number[f.a], number[f.b], number[f.c]}, f.weight);
      const std::array<std::uint32_t, 3>& c = all[i].corners;
      if (c[0] == c[1] || c[1] == c[2] ||
          areCollinear(welded.points[c[0]], welded.points[c[1]], welded.points[c[2]]))
        all[i].weight = 0;
    }
  });
  const auto solid =
      std::remove_if(all.begin(), all.end(), [](const WeldedFace& f) { return f.weight == 0; });
  welded.flat = static_cast<std::size_t>(all.end() - solid);
  all.erase(solid, all.end());
  return welded;
}

} // namespace tetvdb
