// SPDX-License-Identifier: Apache-2.0
//
// The winding number of an open surface, from its boundary edges.
//
// Let S be an oriented surface with boundary curve g, and let a curtain extend from g upward to
// infinity. Surface and curtain together are closed, so that their winding number at a point p is
// an integer. Since the curtain is vertical, it equals the number N(p) of faces of S that a
// downward ray from p crosses, signed: +1 for a face that is oriented downward. Hence
//
//     winding number of S at p  =  N(p) + s(p),   s(p) = - winding number of the curtain at p,
//
// and s depends on g only: for every boundary edge, the solid angle of a triangle with one corner
// at infinity. N is exact (signed crossings); s is smooth except for integer jumps where p passes
// through the curtain (docs/algorithms.md).
#pragma once

#include "tetvdb/geometry/BoundaryEdgeMoments.h"
#include "tetvdb/geometry/BoundaryEdgeSums.h"
#include "tetvdb/geometry/DipoleMoments.h"
#include "tetvdb/geometry/Lattice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// An edge that faces traverse `weight` times more often from a to b than from b to a.
struct BoundaryEdge {
  LatticePoint a, b;
  std::int32_t weight;
};

/// Error of BoundaryWinding::at(), as a winding number, for up to kManyBoundaryEdges edges. Soups
/// with more boundary edges have faces of arbitrary orientation; for these, clusters are used at
/// smaller distances, as in the fast winding number (Barill et al. 2018), and the error is about
/// kRoughWindingError without a bound.
constexpr double kBoundaryWindingError = 1e-3;
constexpr double kRoughWindingError = 0.02;
constexpr std::size_t kManyBoundaryEdges = 4096;

/// Immutable after construction; queries are thread-safe. Results do not depend on the order of the
/// edges.
class BoundaryWinding {
public:
  /// The edges must be closed: the weights at every point sum to zero. O(n log n).
  explicit BoundaryWinding(std::vector<BoundaryEdge> edges);

  std::size_t edgeCount() const { return edges_.size(); }
  bool empty() const { return edgeCount() == 0; }
  /// Whether there are more than kManyBoundaryEdges edges.
  bool rough() const { return edgeCount() > kManyBoundaryEdges; }

  /// s at `p` moved by (e, e^2, e^3), e -> 0+: the perturbed centre of the ownership rule. Within
  /// kBoundaryWindingError. Exact in which side of the curtain p is on.
  double at(const LatticePoint& p) const;

  /// at() of `points`, which lie within `reach` of `centre`, stored in their sums (old values are
  /// lost). Faster than separate calls: the tree is traversed once.
  void at(const LatticePoint& centre, double reach, BoundaryPoints& points) const;

  /// N + s around a point, off the faces, per lattice unit: the gradient at the point (by Biot and
  /// Savart: minus the magnetic field of a current along the boundary, over 4 pi), its error, and
  /// an upper bound on the second derivative in any direction within `reach`. `bend` is infinite
  /// where the boundary is within reach, and the rest is not computed then.
  struct Slope {
    std::array<double, 3> gradient{0, 0, 0};
    double error = 0;
    double bend = 0;
  };
  Slope slope(const LatticePoint& centre, double reach) const;

private:
  // A cluster of edges about `centre`.
  struct Node {
    LatticePoint boxMin, boxMax, centre;
    double radius;            // of the ends about the centre
    double area;              // of the cone's triangles, all positive
    double length;            // of the edges, by weight
    std::uint32_t begin, end; // edges
    std::uint32_t skip;       // the node after the whole cluster, depth first
    bool leaf;
    std::uint32_t looseBegin, openEnd;
    std::array<double, 3> way;     // sum of the edges as vectors
    std::array<double, 9> current; // of edge vector times middle: xx xy xz yx ...
    DipoleMoments cone;
    EndMoments ends;
  };
  struct OpenEnd {
    LatticePoint point;
    std::int32_t weight;
  };

  struct Item;
  void build(Item* begin, Item* end, const std::vector<BoundaryEdge>& edges);
  void fillMoments(Node& node) const;
  void fillOpenEnds(Node& node);
  // By its edges, by the cone's moments and every open end, or only by moments.
  enum class View { Edges, OpenEnds, Moments };
  View viewOf(const Node& node, const Vec3d& r, double reach) const;
  template <typename Moments>
  static void addMoments(const LatticePoint& centre, const Moments& moments,
                         BoundaryPoints& points);
  static void addCone(const Node& node, BoundaryPoints& points);
  static void addEnds(const Node& node, BoundaryPoints& points);
  std::int64_t turnsAround(const Node& cluster, const LatticePoint& p) const;
  static Vec3d fieldFromAfar(const Node& node, const Vec3d& r);
  double bend(const LatticePoint& centre, double reach) const;
  template <typename Far, typename Near>
  void walk(const Far& far, const Near& near) const;

  BoundaryEdgeArrays edges_;
  std::vector<Node> nodes_;
  std::vector<OpenEnd> openEnds_;
};

/// Of the winding numbers, up to integers, at two points on different sides of the surface where it
/// passes 0.5, without a face between them: where it does, by linear interpolation, from 0 (`from`)
/// to 1. Between the points it changes by less than 0.5.
double halfCrossing(double from, double to);

} // namespace tetvdb
