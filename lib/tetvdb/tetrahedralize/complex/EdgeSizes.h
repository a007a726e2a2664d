// SPDX-License-Identifier: Apache-2.0
//
// Target lengths of edges.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Target lengths at points, stored with these (Point::fineness) in steps of a twelfth of an octave
/// below the greatest.
class EdgeSizes {
public:
  explicit EdgeSizes(double longest);

  double longest() const { return lengths_[0]; }
  double at(const TetComplex::Point& point) const { return lengths_[point.fineness]; }
  /// Of an edge: the mean of its two points.
  double of(const TetComplex::Point& a, const TetComplex::Point& b) const {
    return 0.5 * (at(a) + at(b));
  }
  /// The lowest fineness whose length is no more than `length`; the highest if there is none.
  std::uint8_t finenessOf(double length) const;

  /// Makes sizes follow the surface: at its points `share` of the mean length of its edges there;
  /// away from it larger by `growth` times the distance along edges of tets of weight 1; elsewhere
  /// the longest. Where edges of these sizes would need more than about `mostTets`, none is less
  /// than the length that needs as many. n log n.
  void followSurface(TetComplex& complex, double share, double growth, double mostTets) const;

  /// Makes sizes around tets above `energy` `share` of the mean length of their edges, and
  /// growing from there as above; no size gets larger, or less than `shortest`. Changes nothing and
  /// returns false where that would need more than about `mostTets`.
  bool refine(TetComplex& complex, double energy, double share, double growth, double shortest,
              double mostTets) const;

private:
  void spread(const TetComplex& complex, std::vector<double>& sizes, double growth) const;
  void assign(TetComplex& complex, const std::vector<double>& sizes) const;

  std::array<double, 256> lengths_;
};

} // namespace tetvdb
