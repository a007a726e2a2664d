// SPDX-License-Identifier: Apache-2.0
//
// How long edges shall be, from place to place.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/tetrahedralize/TetComplex.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Lengths that edges are to have at points, kept with these (Point::fineness) in steps of a
/// twelfth of an octave below the greatest.
class EdgeSizes {
public:
  explicit EdgeSizes(double longest);

  double longest() const { return lengths_[0]; }
  double at(const TetComplex::Point& point) const { return lengths_[point.fineness]; }
  /// Of an edge: the mean of its ends.
  double of(const TetComplex::Point& a, const TetComplex::Point& b) const {
    return 0.5 * (at(a) + at(b));
  }
  /// The least fineness whose length is no more than that, as far as there is one.
  std::uint8_t finenessOf(double length) const;

  /// Sizes follow the surface: at its points they are `share` of the mean length of its edges
  /// there, and from there on they grow with the way along edges, `growth` times it, through tets
  /// of weight 1. Elsewhere they are the longest. n log n.
  void followSurface(TetComplex& complex, double share, double growth) const;

  /// Makes sizes around tets above `energy` `share` of the mean length of their edges, and grow
  /// from there as above; none gets larger, or shorter than `shortest`.
  void refine(TetComplex& complex, double energy, double share, double growth,
              double shortest) const;

private:
  void spread(TetComplex& complex, std::vector<double>& sizes, double growth) const;

  std::array<double, 256> lengths_;
};

} // namespace tetvdb
