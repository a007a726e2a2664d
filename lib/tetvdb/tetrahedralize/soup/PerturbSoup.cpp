// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/PerturbSoup.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/core/MixBits.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <cmath>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace tetvdb {
namespace {

// A random point of the unit ball, by rejection from its cube.
Vec3d randomInBall(std::uint64_t seed) {
  for (std::uint64_t i = 0;; ++i) {
    std::uint64_t random = hashOfIndex(seed * 64 + i);
    Vec3d p{};
    for (double& coordinate : p) {
      coordinate = static_cast<double>(random & 0xFFFFFu) / 0x80000 - 1; // [-1, 1)
      random >>= 20;
    }
    if (dot(p, p) < 1)
      return p;
  }
}

// For every face the lowest face of its component.
std::vector<std::uint32_t> componentsOf(const LatticeSoup& soup) {
  DisjointSets sets(soup.faces.size());
  std::unordered_map<std::uint64_t, std::uint32_t> firstAt;
  for (std::uint32_t face = 0; face < soup.faces.size(); ++face)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& corners = soup.faces[face];
      sets.join(firstAt.emplace(edgeKey(corners[i], corners[(i + 1) % 3]), face).first->second,
                face);
    }
  std::vector<std::uint32_t> component(soup.faces.size());
  for (std::uint32_t face = 0; face < soup.faces.size(); ++face)
    component[face] = sets.find(face);
  return component;
}

// A point that several components share becomes one point for each.
void moveComponents(LatticeSoup& soup, double distance, std::uint64_t seed) {
  const std::vector<std::uint32_t> component = componentsOf(soup);
  std::vector<bool> open(soup.faces.size(), false);
  std::unordered_set<std::uint64_t> boundary;
  for (const auto& [a, b] : openEdges(soup))
    boundary.insert(edgeKey(a, b));
  for (std::size_t face = 0; face < soup.faces.size(); ++face)
    for (std::size_t i = 0; i < 3; ++i)
      if (boundary.count(edgeKey(soup.faces[face][i], soup.faces[face][(i + 1) % 3])) != 0)
        open[component[face]] = true;
  std::vector<Vec3d> points;
  std::unordered_map<std::uint64_t, std::uint32_t> moved; // by component and point
  for (std::size_t face = 0; face < soup.faces.size(); ++face)
    for (std::uint32_t& corner : soup.faces[face]) {
      const auto [known, isNew] = moved.emplace(std::uint64_t(component[face]) << 32 | corner,
                                                static_cast<std::uint32_t>(points.size()));
      if (isNew) {
        const Vec3d by = open[component[face]]
                             ? Vec3d{0, 0, 0}
                             : times(randomInBall(seed << 32 | component[face]), distance);
        points.push_back(roundToGrain(plus(soup.points[corner], by), soup.grain));
      }
      corner = known->second;
    }
  soup.points = std::move(points);
}

} // namespace

LatticeSoup perturbedSoup(const LatticeSoup& soup, double distance, Perturb what,
                          std::uint32_t seed) {
  LatticeSoup perturbed = soup;
  // Rounding to the grain moves by half a cell's diagonal at most.
  const double by = std::max(0.0, distance - std::sqrt(0.75) * soup.grain);
  if (what == Perturb::Components)
    moveComponents(perturbed, by, seed);
  else
    for (std::size_t p = 0; p < perturbed.points.size(); ++p)
      perturbed.points[p] = roundToGrain(
          plus(perturbed.points[p], times(randomInBall(std::uint64_t(seed) << 32 | p), by)),
          soup.grain);
  Progress quiet;
  tidySoup(perturbed, quiet);
  return perturbed;
}

} // namespace tetvdb
