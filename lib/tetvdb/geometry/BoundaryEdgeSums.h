// SPDX-License-Identifier: Apache-2.0
//
// Sums over boundary edges seen from a point: the innermost loops of BoundaryWinding, vectorised,
// with the same bits for every instruction set.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/Lattice.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

/// q relative to p.
TETVDB_HD inline Vec3d from(const LatticePoint& p, const LatticePoint& q) {
  return {q.x - p.x, q.y - p.y, q.z - p.z};
}

/// End points and weights of edges, one array per coordinate.
struct BoundaryEdgeView {
  const double *ax, *ay, *az, *bx, *by, *bz, *weight;
};

/// A growing list of edges.
struct BoundaryEdgeArrays {
  std::vector<double> ax, ay, az, bx, by, bz, weight;

  void push(const LatticePoint& a, const LatticePoint& b, double w);
  BoundaryEdgeView view() const {
    return {ax.data(), ay.data(), az.data(), bx.data(), by.data(), bz.data(), weight.data()};
  }
  std::size_t size() const { return ax.size(); }
  LatticePoint a(std::size_t i) const { return {ax[i], ay[i], az[i]}; }
  LatticePoint b(std::size_t i) const { return {bx[i], by[i], bz[i]}; }
};

/// Space for a few edges without allocation.
template <std::size_t Size>
struct BoundaryEdgeBlock {
  double ax[Size], ay[Size], az[Size], bx[Size], by[Size], bz[Size], weight[Size];

  void set(std::size_t i, const LatticePoint& a, const LatticePoint& b, double w) {
    ax[i] = a.x;
    ay[i] = a.y;
    az[i] = a.z;
    bx[i] = b.x;
    by[i] = b.y;
    bz[i] = b.z;
    weight[i] = w;
  }
  BoundaryEdgeView view() const { return {ax, ay, az, bx, by, bz, weight}; }
};

/// a.x b.y - a.y b.x, with its sign after the point to which both are relative is moved by (e,
/// e^2, e^3), e -> 0+; 0 only if a and b have the same x and y. Components are integers below
/// 2^53.
double turn(const Vec3d& a, const Vec3d& b);

/// Solid angle of the spherical triangle of directions a, b and up, seen from 0 moved by (e, e^2,
/// e^3), e -> 0+. Components are integers below 2^53.
double angleUp(const Vec3d& a, const Vec3d& b);

/// Sum of weight * angleUp() over edges begin..end seen from p, each within 1e-10.
double sumAngles(BoundaryEdgeView edges, std::size_t begin, std::size_t end, const LatticePoint& p);

/// Viewpoints that are processed together, and a sum for each.
struct BoundaryPoints {
  std::vector<double> x, y, z, sum;

  std::size_t size() const { return x.size(); }
};

/// Adds weight * angleUp() of one edge, seen from each of the points, to their sums. `scratch` is
/// as long as the points.
void addAngles(const LatticePoint& a, const LatticePoint& b, double weight, BoundaryPoints& points,
               std::vector<double>& scratch);

/// The field of currents along edges begin..end, of the strength of their weights, at p: sum of the
/// integrals of r x dl / |r|^3, r from p (Biot and Savart).
Vec3d sumField(BoundaryEdgeView edges, std::size_t begin, std::size_t end, const LatticePoint& p);

/// Bound on the field's derivative within `reach` of p: |d/dr (r / |r|^3)| is 2 / |r|^3, whose
/// integral over an infinite straight line is 4 / d^2. Infinite if an edge is within reach.
double sumBend(BoundaryEdgeView edges, std::size_t begin, std::size_t end, const LatticePoint& p,
               double reach);

} // namespace tetvdb
