// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/ShakeSoup.h"

#include "tetvdb/core/MixBits.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/WorkingLattice.h"

#include <cmath>
#include <numeric>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace tetvdb {
namespace {

// Within a ball of radius 1: of its cube's points those inside, tried in turn.
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

// Of every face the lowest of its piece.
std::vector<std::uint32_t> piecesOf(const LatticeSoup& soup) {
  std::vector<std::uint32_t> parent(soup.faces.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto rootOf = [&](std::uint32_t face) {
    while (parent[face] != face)
      face = parent[face] = parent[parent[face]];
    return face;
  };
  std::unordered_map<std::uint64_t, std::uint32_t> firstAt;
  for (std::uint32_t face = 0; face < soup.faces.size(); ++face)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& corners = soup.faces[face];
      const auto [first, isNew] = firstAt.emplace(edgeKey(corners[i], corners[(i + 1) % 3]), face);
      if (isNew)
        continue;
      const std::uint32_t a = rootOf(first->second), b = rootOf(face);
      parent[std::max(a, b)] = std::min(a, b);
    }
  for (std::uint32_t face = 0; face < soup.faces.size(); ++face)
    parent[face] = rootOf(face);
  return parent;
}

// Points that pieces share at corners alone become one for each.
void movePieces(LatticeSoup& soup, double distance, std::uint64_t seed) {
  const std::vector<std::uint32_t> piece = piecesOf(soup);
  std::vector<bool> open(soup.faces.size(), false);
  std::unordered_set<std::uint64_t> rim;
  for (const auto& [a, b] : openEdges(soup))
    rim.insert(edgeKey(a, b));
  for (std::size_t face = 0; face < soup.faces.size(); ++face)
    for (std::size_t i = 0; i < 3; ++i)
      if (rim.count(edgeKey(soup.faces[face][i], soup.faces[face][(i + 1) % 3])) != 0)
        open[piece[face]] = true;
  std::vector<Vec3d> points;
  std::unordered_map<std::uint64_t, std::uint32_t> moved; // by piece and point
  for (std::size_t face = 0; face < soup.faces.size(); ++face)
    for (std::uint32_t& corner : soup.faces[face]) {
      const auto [known, isNew] = moved.emplace(std::uint64_t(piece[face]) << 32 | corner,
                                                static_cast<std::uint32_t>(points.size()));
      if (isNew) {
        const Vec3d by = open[piece[face]]
                             ? Vec3d{0, 0, 0}
                             : times(randomInBall(seed << 32 | piece[face]), distance);
        points.push_back(roundToGrain(plus(soup.points[corner], by), soup.grain));
      }
      corner = known->second;
    }
  soup.points = std::move(points);
}

} // namespace

LatticeSoup shakenSoup(const LatticeSoup& soup, double distance, bool pieces, std::uint32_t seed) {
  LatticeSoup shaken = soup;
  // Rounding to the grain moves by half a cell's diagonal at most.
  const double by = std::max(0.0, distance - std::sqrt(0.75) * soup.grain);
  if (pieces)
    movePieces(shaken, by, seed);
  else
    for (std::size_t p = 0; p < shaken.points.size(); ++p)
      shaken.points[p] = roundToGrain(
          plus(shaken.points[p], times(randomInBall(std::uint64_t(seed) << 32 | p), by)),
          soup.grain);
  Progress quiet;
  tidySoup(shaken, quiet);
  return shaken;
}

} // namespace tetvdb
