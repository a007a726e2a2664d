// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/SwapEdges.h"

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
  std::vector<std::pair<float, std::uint32_t>> order;
  for (std::uint32_t t = 0; t < complex_.tets.size(); ++t) {
    const TetComplex::Tet& tet = complex_.tets[t];
    if (!tet.exists())
      continue;
    bool changed = false;
    for (const std::uint32_t corner : tet.corners)
      changed = changed || (complex_.points[corner].changed & kChanged);
    if (changed && energyOf(complex_, t) > energy_)
      order.push_back({-tet.energy, t});
  }
  for (TetComplex::Point& point : complex_.points)
    point.changed = static_cast<std::uint8_t>(point.changed & ~kChanged);
  std::sort(order.begin(), order.end());
  std::size_t swaps = 0;
  for (const auto& [energy, t] : order)
    if (complex_.tets[t].exists() && energyOf(complex_, t) == -energy)
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
  for (unsigned k = 0; k < 4; ++k)
    if (k != i && k != j && tet.tracked[k])
      return;
  ++tried_;
  a_ = tet.corners[i];
  b_ = tet.corners[j];
  if (!complex_.ring(a_, b_, tetsAround_, ringPoints_, t)) {
    // Perhaps in another part.
    tryAgain(a_);
    tryAgain(b_);
    return;
  }
  const std::size_t count = ringPoints_.size();
  if (count > kMostAround)
    return;
  double worst = 0;
  for (const std::uint32_t around : tetsAround_) {
    const TetComplex::Tet& other = complex_.tets[around];
    for (unsigned k = 0; k < 4; ++k)
      if (other.tracked[k] && other.corners[k] != a_ && other.corners[k] != b_)
        return;
    worst = std::max(worst, static_cast<double>(energyOf(complex_, around)));
  }
  const double limit = std::min(best_.cube, cubeOf(kGain * worst));
  for (std::size_t first = count - 1; first-- > 0;) {
    cost_[first][first + 1] = 0;
    for (std::size_t last = first + 2; last < count; ++last) {
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = first + 1; k < last; ++k) {
        double cost = std::max(cost_[first][k], cost_[k][last]);
        if (cost >= std::min(limit, least))
          continue;
        cost = std::max(cost, trianglesCube(first, k, last));
        if (cost >= least)
          continue;
        least = cost;
        apex_[first][last] = static_cast<std::uint8_t>(k);
      }
      cost_[first][last] = least;
    }
  }
  if (!(cost_[0][count - 1] < limit))
    return;
  best_.cube = cost_[0][count - 1];
  best_.old = tetsAround_;
  best_.fresh.clear();
  addTriangles(0, count - 1);
}

// Of the tets over triangle (i, k, j), counter-clockwise seen from b.
double EdgeSwapper::trianglesCube(std::size_t i, std::size_t k, std::size_t j) const {
  const Vec3d &p = complex_.at(ringPoints_[i]), &q = complex_.at(ringPoints_[k]),
              &r = complex_.at(ringPoints_[j]);
  return std::max(energyCube(p, q, r, complex_.at(b_)), energyCube(p, r, q, complex_.at(a_)));
}

void EdgeSwapper::addTriangles(std::size_t i, std::size_t j) {
  if (j - i < 2)
    return;
  const std::size_t k = apex_[i][j];
  TetComplex::NewTet one;
  one.corners = {ringPoints_[i], ringPoints_[k], ringPoints_[j], b_};
  best_.fresh.push_back(one);
  one.corners = {ringPoints_[i], ringPoints_[j], ringPoints_[k], a_};
  best_.fresh.push_back(one);
  addTriangles(i, k);
  addTriangles(k, j);
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
    cube = std::max(
        cube, energyCube(complex_.at(p), complex_.at(q), complex_.at(top), complex_.at(bottom)));
    if (!(cube < limit))
      return;
  }
  best_.cube = cube;
  best_.old = {t, other};
  best_.fresh.assign(fresh.begin(), fresh.end());
}

} // namespace tetvdb
