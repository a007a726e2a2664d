// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/WeldedFaces.h"

#include "tetvdb/geometry/Orientation.h"

#include <algorithm>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tuple>
#include <utility>

namespace tetvdb {
namespace {

struct Place {
  Vec3d at;
  std::uint32_t point;
  bool operator<(const Place& o) const { return at < o.at; }
};

// Fills points, `first` and `extent`, and says which of them every point of the mesh is.
std::vector<std::uint32_t> weldPoints(const SnappedMesh& mesh, const Boundary& boundary,
                                      WeldedFaces& welded) {
  std::vector<std::uint8_t> used(mesh.pointCount, 0);
  for (const BoundaryFace& f : boundary.faces)
    used[f.a] = used[f.b] = used[f.c] = 1;
  std::vector<Place> places;
  places.reserve(mesh.pointCount);
  constexpr double kFar = std::numeric_limits<double>::infinity();
  LatticePoint& first = welded.first;
  first = {kFar, kFar, kFar};
  for (std::uint32_t i = 0; i < mesh.pointCount; ++i)
    if (used[i] != 0) {
      const LatticePoint& p = mesh.points[i];
      places.push_back({{p.x, p.y, p.z}, i});
      first = {std::min(first.x, p.x), std::min(first.y, p.y), std::min(first.z, p.z)};
    }
  tbb::parallel_sort(places.begin(), places.end());
  std::vector<std::uint32_t> number(mesh.pointCount, 0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3d& at = places[i].at;
    if (i == 0 || at != places[i - 1].at) {
      welded.points.push_back({at[0] - first.x, at[1] - first.y, at[2] - first.z});
      for (const double c : welded.points.back())
        welded.extent = std::max(welded.extent, c);
    }
    number[places[i].point] = static_cast<std::uint32_t>(welded.points.size() - 1);
  }
  return number;
}

WeldedFace ascending(std::array<std::uint32_t, 3> c, std::int32_t weight) {
  const auto order = [&](std::size_t i, std::size_t k) {
    if (c[i] > c[k]) {
      std::swap(c[i], c[k]);
      weight = -weight;
    }
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return {c, weight};
}

} // namespace

WeldedFaces weldFaces(const SnappedMesh& mesh, const Boundary& boundary, Progress& progress) {
  progress.check();
  WeldedFaces welded;
  const std::vector<std::uint32_t> number = weldPoints(mesh, boundary, welded);
  progress.check();
  const std::size_t count = boundary.faces.size();
  std::vector<WeldedFace> all(count);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const BoundaryFace& f = boundary.faces[i];
      all[i] = ascending({number[f.a], number[f.b], number[f.c]}, f.weight);
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
  tbb::parallel_sort(all.begin(), all.end(), [](const WeldedFace& a, const WeldedFace& b) {
    return std::tie(a.corners, a.weight) < std::tie(b.corners, b.weight);
  });
  for (std::size_t i = 0; i < all.size();) {
    WeldedFace sum = all[i];
    const std::size_t begin = i;
    for (++i; i < all.size() && all[i].corners == sum.corners; ++i)
      sum.weight += all[i].weight;
    if (sum.weight != 0)
      welded.faces.push_back(sum);
    else
      welded.cancelled += i - begin;
  }
  return welded;
}

} // namespace tetvdb
