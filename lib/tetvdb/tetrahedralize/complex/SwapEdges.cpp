// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/SwapEdges.h"

#include "tetvdb/tetrahedralize/complex/SheetEdge.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace tetvdb {
namespace {

// A swap has to improve the energy by this factor; with a smaller gain swaps could cycle.
constexpr double kGain = 0.99;

double cubeOf(double x) {
  return x * x * x;
}

} // namespace

std::size_t EdgeSwapper::sweep() {
  const auto order = takeChangedTets(complex_, kChanged, energy_, 0);
  std::size_t swaps = 0;
  for (const auto& [energy, t] : order)
    if (complex_.tets[t].exists() && energyOf(complex_, t) == energy)
      swaps += swapAt(t);
  return swaps;
}

bool EdgeSwapper::swapAt(std::uint32_t t) {
  best_.cube = std::numeric_limits<double>::infinity();
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = i + 1; j < 4; ++j)
      tryEdge(t, i, j);
  for (unsigned localFace = 0; localFace < 4; ++localFace)
    tryFace(t, localFace);
  if (best_.cube == std::numeric_limits<double>::infinity())
    return false;
  complex_.replace(best_.old, best_.fresh);
  return true;
}

void EdgeSwapper::tryEdge(std::uint32_t t, unsigned i, unsigned j) {
  const TetComplex::Tet& tet = complex_.tets[t];
  ++tried_;
  a_ = tet.corners[i];
  b_ = tet.corners[j];
  const double worst = tet.energy;
  tetsAround_.clear();
  ringPoints_.clear();
  std::size_t sheets = 0;
  std::array<std::size_t, 2> tracked{0, 0}; // ring points of tracked faces
  for (std::uint32_t next = t;;) {
    const TetComplex::Tet& around = complex_.tets[next];
    const auto [k, l] = kEdgeOthers[around.cornerOf(a_)][around.cornerOf(b_)];
    // The face at the first of its two points around.
    if (around.tracked[l]) {
      if (sheets == 2)
        return;
      tracked[sheets++] = ringPoints_.size();
    }
    tetsAround_.push_back(next);
    ringPoints_.push_back(around.corners[k]);
    next = around.neighbours[k];
    if (next == t)
      break;
    if (next == TetComplex::kOutside)
      return;
    if (next >= TetComplex::kElsewhere) {
      // Perhaps in another part.
      complex_.points[a_].setChanged(kChanged);
      complex_.points[b_].setChanged(kChanged);
      return;
    }
    // The worst tet around the edge is the one that tries.
    const double energy = energyOf(complex_, next);
    if (energy > worst || (energy == worst && next < t) || tetsAround_.size() == kMaxAround)
      return;
  }
  const double limit = std::min(best_.cube, cubeOf(kGain * worst));
  if (sheets == 0)
    tryInside(limit);
  else if (sheets == 2)
    tryOnSurface(tracked[0], tracked[1], limit);
}

void EdgeSwapper::tryInside(double limit) {
  const std::size_t count = ringPoints_.size();
  const float weight = complex_.tets[tetsAround_[0]].weight;
  const double cube = triangulate(0, count - 1, weight, limit);
  if (!(cube < limit))
    return;
  best_.cube = cube;
  best_.old = tetsAround_;
  best_.fresh.clear();
  addTriangles(0, count - 1, weight);
}

// Joins points c and d, the third points of the two tracked faces at the edge; they divide the
// points around it in two.
void EdgeSwapper::tryOnSurface(std::size_t c, std::size_t d, double limit) {
  const std::size_t count = ringPoints_.size();
  const auto chainOf = [&](std::size_t tet, std::size_t point) {
    const TetComplex::Tet& around = complex_.tets[tetsAround_[tet]];
    return around.chains[around.cornerOf(ringPoints_[point])];
  };
  // Seen from the tets between c and d: out through (a, b, c), out through (a, b, d).
  const Chain chain = chainOf(c, (c + 1) % count);
  if (chainOf(d - 1, d - 1) != chain)
    return;
  // Where one tet alone is between c and d, the new tracked faces are its other two.
  const std::uint32_t first = ringPoints_[c], second = ringPoints_[d];
  if (d - c == 1 || count - (d - c) == 1) {
    const std::uint32_t alone = tetsAround_[d - c == 1 ? c : d];
    const TetComplex::Tet& tet = complex_.tets[alone];
    for (const std::uint32_t point : {a_, b_}) {
      const unsigned localFace = tet.cornerOf(point);
      if (tet.tracked[localFace] || tet.neighbours[localFace] >= TetComplex::kElsewhere)
        return;
    }
    if (edgeOnSheet(complex_, first, second, alone) != OnSheet::No)
      return;
  }
  // So that c comes first: the other side follows round.
  std::rotate(ringPoints_.begin(), ringPoints_.begin() + static_cast<std::ptrdiff_t>(c),
              ringPoints_.end());
  ringPoints_.push_back(first);
  const std::size_t apart = d - c;
  const float weights[2] = {complex_.tets[tetsAround_[c]].weight,
                            complex_.tets[tetsAround_[d % count]].weight};
  const double cube = std::max(triangulate(0, apart, weights[0], limit),
                               triangulate(apart, count, weights[1], limit));
  if (!(cube < limit) ||
      !guard_.allowsFlip(complex_.at(a_), complex_.at(b_), complex_.at(first), complex_.at(second)))
    return;
  best_.cube = cube;
  best_.old = tetsAround_;
  best_.fresh.clear();
  const auto addSide = [&](std::size_t from, std::size_t to, Chain out, float weight) {
    const std::size_t base = best_.fresh.size();
    addTriangles(from, to, weight);
    if (to - from < 2)
      return;
    // The first two are over the triangle at c and d; its apex is their second and third corner.
    for (std::size_t k = 0; k < 2; ++k) {
      best_.fresh[base + k].chains[k + 1] = out;
      best_.fresh[base + k].tracked[k + 1] = true;
    }
  };
  addSide(0, apart, chain, weights[0]);
  addSide(apart, count, -chain, weights[1]);
}

// The minimum of the worst cube over the polygon of points from..to; infinity where none is below
// `limit`.
double EdgeSwapper::triangulate(std::size_t from, std::size_t to, float weight, double limit) {
  const double cubed = static_cast<double>(weight) * weight * weight;
  for (std::size_t first = to; first-- > from;) {
    cost_[first][first + 1] = 0;
    for (std::size_t last = first + 2; last <= to; ++last) {
      double minCost = std::numeric_limits<double>::infinity();
      for (std::size_t k = first + 1; k < last; ++k) {
        double cost = std::max(cost_[first][k], cost_[k][last]);
        if (cost >= std::min(limit, minCost))
          continue;
        cost = std::max(cost, cubed * trianglesCube(first, k, last));
        if (cost >= minCost)
          continue;
        minCost = cost;
        apex_[first][last] = static_cast<std::uint8_t>(k);
      }
      cost_[first][last] = minCost;
    }
  }
  return cost_[from][to];
}

// Of the tets over triangle (i, k, j), counter-clockwise seen from b.
double EdgeSwapper::trianglesCube(std::size_t i, std::size_t k, std::size_t j) const {
  const Vec3d &p = complex_.at(ringPoints_[i]), &q = complex_.at(ringPoints_[k]),
              &r = complex_.at(ringPoints_[j]);
  return std::max(energyCube(p, q, r, complex_.at(b_)), energyCube(p, r, q, complex_.at(a_)));
}

void EdgeSwapper::addTriangles(std::size_t i, std::size_t j, float weight) {
  if (j - i < 2)
    return;
  const std::size_t k = apex_[i][j];
  TetComplex::NewTet one;
  one.weight = weight;
  one.corners = {ringPoints_[i], ringPoints_[k], ringPoints_[j], b_};
  best_.fresh.push_back(one);
  one.corners = {ringPoints_[i], ringPoints_[j], ringPoints_[k], a_};
  best_.fresh.push_back(one);
  addTriangles(i, k, weight);
  addTriangles(k, j, weight);
}

void EdgeSwapper::tryFace(std::uint32_t t, unsigned localFace) {
  const TetComplex::Tet& tet = complex_.tets[t];
  const std::uint32_t other = tet.neighbours[localFace];
  if (tet.tracked[localFace] || other == TetComplex::kOutside)
    return;
  if (other >= TetComplex::kElsewhere) {
    for (const std::uint8_t k : kFaceCorners[localFace])
      complex_.points[tet.corners[k]].setChanged(kChanged);
    return;
  }
  ++tried_;
  const std::uint32_t top = tet.corners[localFace];
  const std::uint32_t bottom = complex_.tets[other].corners[complex_.localFaceOf(other, t)];
  const double worst = std::max(energyOf(complex_, t), energyOf(complex_, other));
  const double limit = std::min(best_.cube, cubeOf(kGain * worst));
  std::array<TetComplex::NewTet, 3> fresh;
  double cube = 0;
  for (unsigned k = 0; k < 3; ++k) {
    // Counter-clockwise seen from the bottom.
    const std::uint32_t p = tet.corners[kFaceCorners[localFace][k]];
    const std::uint32_t q = tet.corners[kFaceCorners[localFace][(k + 1) % 3]];
    fresh[k].corners = {p, q, top, bottom};
    fresh[k].weight = tet.weight;
    cube = std::max(cube, cubedWeight(tet) * energyCube(complex_.at(p), complex_.at(q),
                                                        complex_.at(top), complex_.at(bottom)));
    if (!(cube < limit))
      return;
  }
  best_.cube = cube;
  best_.old = {t, other};
  best_.fresh.assign(fresh.begin(), fresh.end());
}

} // namespace tetvdb
