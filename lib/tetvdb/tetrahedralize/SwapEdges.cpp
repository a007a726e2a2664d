// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/SwapEdges.h"

#include "tetvdb/tetrahedralize/SheetEdge.h"
#include "tetvdb/tetrahedralize/TetEnergy.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace tetvdb {
namespace {

// Less is not worth it, and might be undone and done again for ever.
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
  for (unsigned slot = 0; slot < 4; ++slot)
    tryFace(t, slot);
  if (best_.cube == std::numeric_limits<double>::infinity())
    return false;
  complex_.replace(best_.old, best_.fresh);
  return true;
}

void EdgeSwapper::tryAgain(std::uint32_t point) {
  std::uint8_t& changed = complex_.points[point].changed;
  changed = static_cast<std::uint8_t>(changed | kChanged);
}

void EdgeSwapper::tryEdge(std::uint32_t t, unsigned i, unsigned j) {
  const TetComplex::Tet& tet = complex_.tets[t];
  ++tried_;
  a_ = tet.corners[i];
  b_ = tet.corners[j];
  const double most = tet.energy;
  tetsAround_.clear();
  ringPoints_.clear();
  std::size_t sheets = 0;
  std::array<std::size_t, 2> ends{0, 0};
  for (std::uint32_t next = t;;) {
    const TetComplex::Tet& around = complex_.tets[next];
    const auto [k, l] = kEdgeOthers[around.cornerOf(a_)][around.cornerOf(b_)];
    // The face at the first of its two points around.
    if (around.tracked[l]) {
      if (sheets == 2)
        return;
      ends[sheets++] = ringPoints_.size();
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
      tryAgain(a_);
      tryAgain(b_);
      return;
    }
    // The worst tet around the edge is the one that tries.
    const double energy = energyOf(complex_, next);
    if (energy > most || (energy == most && next < t) || tetsAround_.size() == kMostAround)
      return;
  }
  const double limit = std::min(best_.cube, cubeOf(kGain * most));
  if (sheets == 0)
    tryInside(limit);
  else if (sheets == 2)
    tryOnSurface(ends[0], ends[1], limit);
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

// Points c and d, where the two tracked faces at the edge end, become joined instead; the points
// around are parted there.
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
    for (const std::uint32_t end : {a_, b_}) {
      const unsigned slot = tet.cornerOf(end);
      if (tet.tracked[slot] || tet.neighbours[slot] >= TetComplex::kElsewhere)
        return;
    }
    if (edgeOnSheet(complex_, first, second, alone) != OnSheet::No)
      return;
  }
  // So that c comes first: the other side follows round.
  std::rotate(ringPoints_.begin(), ringPoints_.begin() + static_cast<std::ptrdiff_t>(c),
              ringPoints_.end());
  ringPoints_.push_back(first);
  const std::size_t middle = d - c;
  const float weights[2] = {complex_.tets[tetsAround_[c]].weight,
                            complex_.tets[tetsAround_[d % count]].weight};
  const double cube = std::max(triangulate(0, middle, weights[0], limit),
                               triangulate(middle, count, weights[1], limit));
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
  addSide(0, middle, chain, weights[0]);
  addSide(middle, count, -chain, weights[1]);
}

// The least worst cube over the polygon of points from..to; infinity where none is below `limit`.
double EdgeSwapper::triangulate(std::size_t from, std::size_t to, float weight, double limit) {
  const double cubed = static_cast<double>(weight) * weight * weight;
  for (std::size_t first = to; first-- > from;) {
    cost_[first][first + 1] = 0;
    for (std::size_t last = first + 2; last <= to; ++last) {
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = first + 1; k < last; ++k) {
        double cost = std::max(cost_[first][k], cost_[k][last]);
        if (cost >= std::min(limit, least))
          continue;
        cost = std::max(cost, cubed * trianglesCube(first, k, last));
        if (cost >= least)
          continue;
        least = cost;
        apex_[first][last] = static_cast<std::uint8_t>(k);
      }
      cost_[first][last] = least;
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

void EdgeSwapper::tryFace(std::uint32_t t, unsigned slot) {
  const TetComplex::Tet& tet = complex_.tets[t];
  const std::uint32_t other = tet.neighbours[slot];
  if (tet.tracked[slot] || other == TetComplex::kOutside)
    return;
  if (other >= TetComplex::kElsewhere) {
    for (const std::uint8_t k : kFaceCorners[slot])
      tryAgain(tet.corners[k]);
    return;
  }
  ++tried_;
  const std::uint32_t top = tet.corners[slot];
  const std::uint32_t bottom = complex_.tets[other].corners[complex_.slotOf(other, t)];
  const double worst = std::max(energyOf(complex_, t), energyOf(complex_, other));
  const double limit = std::min(best_.cube, cubeOf(kGain * worst));
  std::array<TetComplex::NewTet, 3> fresh;
  double cube = 0;
  for (unsigned k = 0; k < 3; ++k) {
    // Counter-clockwise seen from the bottom.
    const std::uint32_t p = tet.corners[kFaceCorners[slot][k]];
    const std::uint32_t q = tet.corners[kFaceCorners[slot][(k + 1) % 3]];
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
