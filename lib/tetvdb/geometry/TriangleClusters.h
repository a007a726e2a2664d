// SPDX-License-Identifier: Apache-2.0
//
// Triangles in a tree of clusters, for sums of their solid angles: distant clusters are evaluated
// as a whole.
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/geometry/BoundaryEdgeSums.h"
#include "tetvdb/geometry/DipoleMoments.h"
#include "tetvdb/geometry/FillHoles.h"
#include "tetvdb/geometry/SolidAngle.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tetvdb {

/// Immutable after construction; depends on the order of the triangles (that of fillHoles()).
class TriangleClusters {
public:
  struct Cluster {
    LatticePoint low, high; ///< box
    LatticePoint centre;
    double radius;            ///< of the corners about the centre
    double area;              ///< of the triangles, by weight
    double third;             ///< bound on the integral of |y|^3 over them, y from the centre
    std::uint32_t begin, end; ///< triangles
    std::uint32_t second;     ///< the first child is the next cluster, this the second; 0: none
    DipoleMoments moments;

    /// Bound on the error of moments.angle() from a point at distance `away` from the centre;
    /// infinite within the radius.
    TETVDB_HD double momentsError(double away) const {
      if (!(away > radius))
        return std::numeric_limits<double>::infinity();
      // The parts of the expansion in y that are left out, n from 3 on: (n + 1) |y|^n / away^(n +
      // 2) each.
      const double square = away * away, left = 1 - radius / away;
      return 4 * third / (square * square * away * left * left);
    }
  };

  /// O(n log n), parallel.
  explicit TriangleClusters(std::vector<FillTriangle> triangles);

  bool empty() const { return triangles_.empty(); }
  std::size_t triangleCount() const { return triangles_.size(); }
  /// The first one holds all triangles.
  const std::vector<Cluster>& clusters() const { return clusters_; }
  const FillTriangle& triangle(std::size_t i) const { return triangles_[i]; }
  const std::vector<FillTriangle>& triangles() const { return triangles_; }
  const std::vector<double>& areas() const { return areas_; }
  double area(std::size_t i) const { return areas_[i]; } ///< by weight

private:
  void build(std::uint32_t index, std::uint32_t begin, std::uint32_t end);
  void summarize(Cluster& cluster) const;

  std::vector<FillTriangle> triangles_;
  std::vector<double> areas_;
  std::vector<Cluster> clusters_;
};

/// Relative to `p`.
TETVDB_HD inline SeenTriangle seenFrom(const LatticePoint& p, const FillTriangle& t) {
  return {from(p, t.a), from(p, t.b), from(p, t.c)};
}

/// Adds moments.angle() at points relative to `p`.
void addMoments(const TriangleClusters::Cluster& cluster, const LatticePoint& p,
                const PointSums& points);

} // namespace tetvdb
