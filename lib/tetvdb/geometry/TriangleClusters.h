// SPDX-License-Identifier: Apache-2.0
//
// Triangles in a tree of clusters, for sums of their solid angles: distant clusters are evaluated
// as a whole.
#pragma once

#include "tetvdb/geometry/DipoleMoments.h"
#include "tetvdb/geometry/FillHoles.h"
#include "tetvdb/geometry/SolidAngle.h"

#include <cstddef>
#include <cstdint>
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
    double momentsError(double away) const;
  };

  /// O(n log n), parallel.
  explicit TriangleClusters(std::vector<FillTriangle> triangles);

  bool empty() const { return triangles_.empty(); }
  std::size_t triangleCount() const { return triangles_.size(); }
  /// The first one holds all triangles.
  const std::vector<Cluster>& clusters() const { return clusters_; }
  const FillTriangle& triangle(std::size_t i) const { return triangles_[i]; }
  double area(std::size_t i) const { return areas_[i]; } ///< by weight

private:
  void build(std::uint32_t index, std::uint32_t begin, std::uint32_t end);
  void summarize(Cluster& cluster) const;

  std::vector<FillTriangle> triangles_;
  std::vector<double> areas_;
  std::vector<Cluster> clusters_;
};

/// Relative to `p`.
SeenTriangle seenFrom(const LatticePoint& p, const FillTriangle& t);

/// Adds moments.angle() at points relative to `p`.
void addMoments(const TriangleClusters::Cluster& cluster, const LatticePoint& p,
                const PointSums& points);

} // namespace tetvdb
