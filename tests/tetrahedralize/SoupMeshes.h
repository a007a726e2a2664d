// SPDX-License-Identifier: Apache-2.0
//
// Soups on the lattice, meshes to put them into, and how far the one is from the other by brute
// force.
#pragma once

#include "TriangleMeshes.h"
#include "tetrahedralize/TetMeshes.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/BackgroundMesh.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <vector>

namespace tetvdb {

constexpr double kSoupScale = 0x1p36; ///< lattice units a unit of the test's meshes
constexpr double kSoupGrain = 16;     ///< lattice units, as few as Delaunay tets of the soups allow

/// On multiples of the grain. Points that are equal are one point, whatever mesh they
/// come from; faces stay as they are, apart from those with a repeated point, which go.
inline LatticeSoup soupOf(const std::vector<TriangleMesh>& meshes) {
  LatticeSoup soup;
  soup.grain = kSoupGrain;
  std::map<Vec3d, std::uint32_t> numbers;
  for (std::size_t input = 0; input < meshes.size(); ++input)
    for (std::size_t i = 0; i + 2 < meshes[input].triangles.size(); i += 3) {
      std::array<std::uint32_t, 3> face{};
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d& p = meshes[input].points[meshes[input].triangles[i + k]];
        const Vec3d at = roundToGrain(times(p, kSoupScale), kSoupGrain);
        const auto [entry, isNew] =
            numbers.try_emplace(at, static_cast<std::uint32_t>(soup.points.size()));
        if (isNew)
          soup.points.push_back(at);
        face[k] = entry->second;
      }
      if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0])
        continue;
      soup.faces.push_back(face);
      if (meshes.size() > 1)
        soup.inputs.push_back(static_cast<std::uint16_t>(input));
    }
  return soup;
}

/// Delaunay tets, their neighbours found again by a map of faces; the box's sides are fixed.
inline TetComplex complexOf(const std::vector<Vec3d>& points, double grain) {
  Progress progress;
  const PlainTets plain = delaunayTets(points, grain, progress);
  TetComplex complex;
  for (const Vec3d& p : points)
    complex.addPoint(p);
  for (const auto& corners : plain.tets) {
    TetComplex::Tet tet{};
    tet.corners = corners;
    complex.tets.push_back(tet);
  }
  connect(complex, std::vector<Chain>(complex.tets.size(), 0));
  for (const auto& tet : complex.tets)
    for (unsigned localFace = 0; localFace < 4; ++localFace)
      if (tet.neighbours[localFace] == TetComplex::kOutside)
        for (const std::uint32_t p : keyOfFace(tet.corners, localFace))
          complex.points[p].fixed = true;
  return complex;
}

/// A soup's points are 8, 9, ... in it.
inline TetComplex complexOf(const LatticeSoup& soup, double spacing) {
  Progress progress;
  return complexOf(backgroundPoints(soup, spacing / 2, spacing, spacing / 8, progress), soup.grain);
}

inline double distanceToSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d along = minus(b, a);
  const double square = dot(along, along);
  const double at = square > 0 ? std::clamp(dot(minus(p, a), along) / square, 0.0, 1.0) : 0;
  return length(minus(p, plus(a, times(along, at))));
}

/// Right also for triangles without area. Of a triangle that is nearly flat the plane is not looked
/// at: the nearest point is then on an edge, up to rounding.
inline double distanceToFace(const Vec3d& p, const std::array<Vec3d, 3>& f) {
  double nearest = std::min({distanceToSegment(p, f[0], f[1]), distanceToSegment(p, f[1], f[2]),
                             distanceToSegment(p, f[2], f[0])});
  const Vec3d u = minus(f[1], f[0]), v = minus(f[2], f[0]);
  const Vec3d normal = cross(u, v);
  const double area = length(normal);
  if (area <= 1e-10 * length(u) * length(v))
    return nearest;
  bool within = true;
  for (std::size_t i = 0; i < 3; ++i)
    within = within && dot(cross(minus(f[(i + 1) % 3], f[i]), minus(p, f[i])), normal) >= 0;
  if (within)
    nearest = std::min(nearest, std::abs(dot(normal, minus(p, f[0]))) / area);
  return nearest;
}

/// Distances of many points from the same faces; faces whose box is farther are passed over.
class FaceDistances {
public:
  void add(const std::array<Vec3d, 3>& face) {
    faces_.push_back(face);
    Box box;
    for (const Vec3d& p : face)
      box.add(p);
    boxes_.push_back(box);
  }

  double operator()(const Vec3d& p) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      double square = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double gap =
            std::max({boxes_[f].low[axis] - p[axis], p[axis] - boxes_[f].high[axis], 0.0});
        square += gap * gap;
      }
      if (square < nearest * nearest)
        nearest = std::min(nearest, distanceToFace(p, faces_[f]));
    }
    return nearest;
  }

private:
  std::vector<std::array<Vec3d, 3>> faces_;
  std::vector<Box> boxes_;
};

/// What input `k` of `count` counts in a chain: its digit.
inline int digitOf(Chain chain, std::size_t k, std::size_t count) {
  if (count == 1)
    return chain;
  const int bits = static_cast<int>(32 / count);
  const std::int64_t base = std::int64_t(1) << bits;
  std::int64_t rest = chain;
  for (std::size_t i = 0;; ++i) {
    std::int64_t digit = ((rest % base) + base) % base;
    if (digit >= base / 2)
      digit -= base;
    if (i == k)
      return static_cast<int>(digit);
    rest = (rest - digit) / base;
  }
}

/// Six times the volume within the faces of an input, by cones to the origin, in whole numbers.
inline Int128 sixfoldVolume(const std::array<Vec3d, 3>& face) {
  Int128 x[3][3];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      x[i][axis] = static_cast<std::int64_t>(face[i][axis]);
  return x[0][0] * (x[1][1] * x[2][2] - x[1][2] * x[2][1]) +
         x[0][1] * (x[1][2] * x[2][0] - x[1][0] * x[2][2]) +
         x[0][2] * (x[1][0] * x[2][1] - x[1][1] * x[2][0]);
}

/// All that a mesh is, to compare byte by byte.
inline std::string bytesOf(const TetComplex& complex) {
  std::string bytes;
  const auto put = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (const auto& point : complex.points) {
    put(point.at);
    put(point.tet);
    put(point.fixed);
    put(point.onBoundary);
  }
  for (const auto& tet : complex.tets) {
    put(tet.corners);
    put(tet.neighbours);
    put(tet.chains);
    put(tet.tracked);
  }
  return bytes;
}

/// work() on that many threads, be there fewer cores or more.
template <typename Work>
auto onThreads(int threads, const Work& work) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  return arena.execute(work);
}

} // namespace tetvdb
