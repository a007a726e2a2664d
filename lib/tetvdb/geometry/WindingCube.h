// SPDX-License-Identifier: Apache-2.0
//
// What WindingBand decides of a cube of voxels and the triangles over holes around it. The same
// source, with the same bits, is used on the CPU and on a GPU.
#pragma once

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/HostDevice.h"
#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/LocalExpansion.h"
#include "tetvdb/geometry/TriangleClusters.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tetvdb {

/// The error of the winding numbers that WindingBand computes: measured, not proved. Each
/// approximated cluster and triangle has a bound, and the sum of these bounds can be larger than
/// this. The largest error that was measured is four tenths of it (docs/algorithms.md, section 8a).
constexpr double kWindingBandError = 1e-3;

/// A winding number this close to a half is one: in the plane of a flat sheet it is but for
/// rounding.
constexpr double kWindingTie = kWindingBandError / 10;

/// The whole number nearest to a winding number, of a half (within kWindingTie) the one nearer to
/// zero: what lies at most half around counts as outside.
TETVDB_HD inline std::int32_t nearestWinding(double winding) {
  const double size = std::ceil(std::abs(winding) - 0.5 - kWindingTie);
  return static_cast<std::int32_t>(winding < 0 ? -size : size);
}

namespace winding {

constexpr double kVoxel = static_cast<double>(kUnitsPerVoxel);
// A half counts as passed slightly beyond it (nearestWinding()), and values have an error.
constexpr double kMargin = 3 * kWindingBandError;
// Clusters smaller than this share of a cube's ball are kept whole while they are near.
constexpr double kKeptWhole = 0.5;

/// Distance to the nearest half.
TETVDB_HD inline double toHalf(double winding) {
  return std::abs(winding - std::floor(winding) - 0.5);
}

/// Of the ball around a cube of so many voxels a side.
TETVDB_HD inline double radiusOf(std::int64_t size) {
  return std::sqrt(0.75) * static_cast<double>(size) * kVoxel;
}

/// The centre of a cube from its first voxel on.
TETVDB_HD inline LatticePoint centreOf(const std::int64_t* first, std::int64_t size) {
  const double half = static_cast<double>(size - 1) / 2;
  return {(static_cast<double>(first[0]) + half) * kVoxel,
          (static_cast<double>(first[1]) + half) * kVoxel,
          (static_cast<double>(first[2]) + half) * kVoxel};
}

/// From the centre of the smallest cubes to voxel (x * 4 + y) * 4 + z of one.
TETVDB_HD inline Vec3d voxelOffset(std::size_t i) {
  const std::size_t x = i / 16, y = i / 4 % 4, z = i % 4;
  return {(static_cast<double>(x) - 1.5) * kVoxel, (static_cast<double>(y) - 1.5) * kVoxel,
          (static_cast<double>(z) - 1.5) * kVoxel};
}

/// From the centre of a cube to the farthest point of the columns that it represents: up to the
/// centre of the voxel below.
TETVDB_HD inline double reachOf(std::int64_t size) {
  const double steps = static_cast<double>(size - 1) / 2;
  return kVoxel * std::sqrt(2 * steps * steps + (steps + 1) * (steps + 1));
}

/// A cube's change of solid angle from which on it is not asked for its value.
constexpr double kMaxChange = 2 * kPi - 4 * kPi * kMargin;

/// Whether a value at the centre, a solid angle, that changes at most so much may pass a half.
TETVDB_HD inline bool mayPass(double midpoint, double change) {
  return toHalf(midpoint / (4 * kPi)) <= change / (4 * kPi) + kMargin;
}

TETVDB_HD inline double distanceToBox(const LatticePoint& p, const LatticePoint& low,
                                      const LatticePoint& high) {
  const auto outside = [](double x, double a, double b) {
    const double below = a - x, above = x - b, beyond = below < above ? above : below;
    return beyond < 0.0 ? 0.0 : beyond;
  };
  return length(
      {outside(p.x, low.x, high.x), outside(p.y, low.y, high.y), outside(p.z, low.z, high.z)});
}

/// What becomes of a cluster in a cube.
enum class Sorted {
  Far,   ///< its moments are added to the expansion
  Whole, ///< kept
  Parts  ///< its parts are sorted instead
};

TETVDB_HD inline Sorted sortedCluster(const TriangleClusters::Cluster& cluster,
                                      const LatticePoint& centre, double radius, double tolerance) {
  const double away = length(from(centre, cluster.centre));
  const double distance =
      std::max(away - cluster.radius, distanceToBox(centre, cluster.low, cluster.high));
  const bool far = distance > radius &&
                   expansionError(distance / radius, cluster.area / (radius * radius)) <= tolerance;
  if (far && cluster.momentsError(away - radius) <= tolerance)
    return Sorted::Far;
  return !far && cluster.radius < kKeptWhole * radius ? Sorted::Whole : Sorted::Parts;
}

/// Whether a triangle is added to the expansion of a cube that sees it so.
TETVDB_HD inline bool isFar(const SeenTriangle& seen, double area, double radius,
                            double tolerance) {
  const double relativeArea = area / (radius * radius);
  const double distance = std::sqrt(nearestOnTriangle(seen.a, seen.b, seen.c).squared);
  return distance > radius && expansionError(distance / radius, relativeArea) <= tolerance;
}

/// Whether moments replace a near cluster in all of a cube.
TETVDB_HD inline bool byMoments(const TriangleClusters::Cluster& cluster,
                                const LatticePoint& centre, double radius, double tolerance) {
  return cluster.momentsError(length(from(centre, cluster.centre)) - radius) <= tolerance;
}

/// How far the part of an edge from a to b in a solid angle gets within `reach` of 0. Its gradient
/// is the field of a current along the edge: f / d around the edge's line, at a distance d from it,
/// with f between 0 and 2, so that it changes by at most twice the angle that one gets around the
/// line; and at a distance h from the edge itself at most 2 / h or length / h^2, here integrated
/// outwards.
TETVDB_HD inline double changeByEdge(const Vec3d& a, const Vec3d& b, double reach) {
  const double h = std::sqrt(nearestOnSegment(a, b).squared), left = h - reach;
  if (!(left > 0))
    return std::numeric_limits<double>::infinity();
  const Vec3d edge = minus(b, a), moment = cross(a, b);
  const double square = dot(edge, edge), span = std::sqrt(square);
  const double q = reach / left;
  // ln(1 + q) <= q (6 + q) / (6 + 4 q)
  double change = std::min(2 * q * (6 + q) / (6 + 4 * q), span * reach / (h * left));
  // asin(x) <= pi x / (2 + sqrt(1 - x^2))
  const double squaredDistance = dot(moment, moment) / square;
  const double cosine = 1 - reach * reach / squaredDistance;
  if (cosine > 0)
    change =
        std::min(change, 2 * kPi * reach / std::sqrt(squaredDistance) / (2 + std::sqrt(cosine)));
  return change;
}

/// How far a triangle's solid angle gets within `reach` of 0, but for jumps by 4 pi where the
/// triangle is crossed.
TETVDB_HD inline double changeOf(const SeenTriangle& t, double area, double weight, double reach) {
  const double byEdges =
      changeByEdge(t.a, t.b, reach) + changeByEdge(t.b, t.c, reach) + changeByEdge(t.c, t.a, reach);
  const double distance = std::sqrt(nearestOnTriangle(t.a, t.b, t.c).squared);
  // The gradient is at most 2 area / distance^3.
  const double left = distance - reach;
  const double byArea = left > 0 ? area * (1 / (left * left) - 1 / (distance * distance))
                                 : std::numeric_limits<double>::infinity();
  return std::min(weight * byEdges, byArea);
}

/// How far a near cluster's solid angle gets within `reach` of 0.
TETVDB_HD inline double changeOf(const TriangleClusters::Cluster& c, const LatticePoint& centre,
                                 double reach) {
  const double left =
      std::max(length(from(centre, c.centre)) - c.radius, distanceToBox(centre, c.low, c.high)) -
      reach;
  return left > 0
             ? c.area * reach * (2 * left + reach) / (left * left * (left + reach) * (left + reach))
             : kMaxChange;
}

} // namespace winding
} // namespace tetvdb
