// SPDX-License-Identifier: Apache-2.0
//
// Computes exactly which voxels' cubes a triangle passes through.
#pragma once

#include "tetvdb/geometry/Exact.h"
#include "tetvdb/geometry/Lattice.h"
#include "tetvdb/voxelize/Slab.h"

#include <array>
#include <cstdint>

namespace tetvdb {

/// A triangle prepared for asking which cubes it passes through. The cube of a voxel reaches half a
/// voxel to each side of its centre; it is open: a triangle that touches it from outside, at a
/// side, an edge or a corner, does not pass through. Triangles without area pass through nothing.
///
/// Two convex bodies of which one is open are disjoint if and only if they are separated, not
/// strictly, along one of the normals of their faces or the cross products of their edges: here the
/// three axes, the normal, and nine products. All of these are decided in integers (after a filter
/// in doubles for the normal).
class TouchedFace {
public:
  TouchedFace(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c);

  /// Voxels whose cubes the triangle's box passes through, inclusive; none where last < first.
  const std::array<std::int64_t, 3>& first() const { return first_; }
  const std::array<std::int64_t, 3>& last() const { return last_; }
  bool passes() const {
    return last_[0] >= first_[0] && last_[1] >= first_[1] && last_[2] >= first_[2];
  }

  /// False where the triangle's plane misses every cube of a node; it may miss others, too.
  bool mayMeet(const NodeIndex& node) const;

  /// Sets the bits of the voxels it passes through in the slab whose first voxel is (x0, y0, z0).
  void rasterize(std::int64_t x0, std::int64_t y0, std::int64_t z0, SlabBits& bits) const;

private:
  // Value of an edge's line in one of the coordinate planes, u and v being the other two axes: for
  // a cube with its centre at (u, v) from the first corner the triangle is beyond the cube where
  // the value is not between low and high.
  struct Line {
    std::int64_t u = 0, v = 0;
    Int128 low = 0, high = 0;
    bool used = false;
  };
  template <typename Int>
  bool between(const Line& line, std::int64_t u, std::int64_t v) const;
  template <typename Int>
  void rasterizeWith(std::int64_t x0, std::int64_t y0, std::int64_t z0, SlabBits& bits) const;
  bool planeMeets(std::int64_t x, std::int64_t y, std::int64_t z) const;

  std::array<std::int64_t, 3> corner_; // the first, lattice
  std::array<std::int64_t, 3> first_, last_;
  std::array<std::array<Line, 3>, 3> lines_; // [axis seen along][edge]
  Int128 normal_[3], reach_;
  double approximate_[3], approximateReach_; // of the normal, and a bound on the error of a value
  double error_;
  bool narrow_; // lines fit 64 bits
};

} // namespace tetvdb
