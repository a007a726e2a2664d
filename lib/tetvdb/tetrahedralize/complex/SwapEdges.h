// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/complex/SurfaceGuard.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Swaps edges and faces of one part, serially: the tets around an edge are replaced by others over
/// the same points without it, two tets with a common face by three with a common edge. Tracked
/// faces stay, except that two that alone meet at an edge may become the other two of their four
/// points, within bounds.
///   The triangulation of the points around an edge whose worst tet is best is found by dynamic
/// programming over polygons, as for triangulations of minimum cost (Klincsek 1980; for tets
/// Shewchuk, "Two Discrete Optimization Algorithms for the Topological Improvement of Tetrahedral
/// Meshes", 2002).
class EdgeSwapper {
public:
  /// Bit of Point::changed.
  static constexpr std::uint8_t kChanged = 2;

  /// Only tets above `energy` are worth a swap.
  EdgeSwapper(TetComplex& complex, const Bounds& bounds, double energy)
      : complex_(complex), energy_(energy), guard_(bounds) {}

  /// Tries every such tet around which something changed since it was last tried, the worst first.
  /// A swap makes the worst of the tets that it concerns better. Returns how many there were.
  std::size_t sweep();

  std::size_t tried() const { return tried_; } ///< edges and faces

private:
  static constexpr std::size_t kMaxAround = 7;

  struct Swap {
    double cube = 0; ///< of the worst new tet's energy
    std::vector<std::uint32_t> old;
    std::vector<TetComplex::NewTet> fresh;
  };

  bool swapAt(std::uint32_t t);
  void tryEdge(std::uint32_t t, unsigned i, unsigned j);
  void tryInside(double limit);
  void tryOnSurface(std::size_t c, std::size_t d, double limit);
  double triangulate(std::size_t from, std::size_t to, float weight, double limit);
  void tryFace(std::uint32_t t, unsigned localFace);
  double trianglesCube(std::size_t i, std::size_t k, std::size_t j) const;
  void addTriangles(std::size_t i, std::size_t j, float weight);

  TetComplex& complex_;
  const double energy_;
  std::size_t tried_ = 0;
  SurfaceGuard guard_;
  Swap best_;
  std::uint32_t a_ = 0, b_ = 0; // the edge
  std::vector<std::uint32_t> tetsAround_, ringPoints_;
  std::array<std::array<double, kMaxAround + 1>, kMaxAround + 1>
      cost_{}; // of the polygon from i to j
  std::array<std::array<std::uint8_t, kMaxAround + 1>, kMaxAround + 1> apex_{};
};

} // namespace tetvdb
