// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/BoundaryLoops.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = EdgeTable::kNone;

// Sides without an opposite side: of each edge, as many as it has in excess in one direction.
std::vector<char> findOpenSides(const EdgeTable& edges, std::size_t sideCount) {
  std::vector<char> isOpen(sideCount, 0);
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    const EdgeTable::Sides sides = edges.sides(edge);
    int excess = edges.imbalance(edge);
    for (const std::uint32_t side : sides) {
      if (excess == 0)
        break;
      if (edges.ascends(side) != (excess > 0))
        continue;
      isOpen[side] = 1;
      excess += excess > 0 ? -1 : 1;
    }
  }
  return isOpen;
}

// The open side that ends where `side` begins, found around the fan of faces between them; kNone if
// an edge of the fan does not have exactly two faces.
std::uint32_t aroundFan(const EdgeTable& edges, const std::vector<char>& isOpen,
                        std::uint32_t side) {
  for (std::uint32_t at = side;;) {
    const std::uint32_t last = EdgeTable::previous(at); // ends at the point
    if (isOpen[last] != 0)
      return last;
    if (!edges.isManifold(edges.edgeOf(last)))
      return kNone;
    const EdgeTable::Sides sides = edges.sides(edges.edgeOf(last));
    at = sides[0] == last ? sides[1] : sides[0];
    if (at == side)
      return kNone;
  }
}

} // namespace

std::vector<BoundaryLoop> findBoundaryLoops(const TriangleMesh& mesh, const EdgeTable& edges) {
  const std::vector<std::uint32_t>& corners = mesh.triangles;
  const std::vector<char> isOpen = findOpenSides(edges, corners.size());
  const auto startOf = [&](std::uint32_t side) { return corners[side]; };
  const auto endOf = [&](std::uint32_t side) { return corners[EdgeTable::next(side)]; };

  // A loop traverses an open side from its end to its beginning and continues with one that ends
  // there.
  std::vector<std::uint32_t> following(corners.size(), kNone);
  std::vector<char> hasPrevious(corners.size(), 0);
  std::vector<std::uint32_t> open;
  for (std::uint32_t side = 0; side < corners.size(); ++side) {
    if (isOpen[side] == 0)
      continue;
    open.push_back(side);
    const std::uint32_t next = aroundFan(edges, isOpen, side);
    if (next != kNone && hasPrevious[next] == 0) {
      following[side] = next;
      hasPrevious[next] = 1;
    }
  }
  // Sides that no fan connects are joined in order: every point has equally many of both kinds.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> starting, ending; // point, side
  for (const std::uint32_t side : open) {
    if (following[side] == kNone)
      starting.emplace_back(startOf(side), side);
    if (hasPrevious[side] == 0)
      ending.emplace_back(endOf(side), side);
  }
  std::sort(starting.begin(), starting.end());
  std::sort(ending.begin(), ending.end());
  for (std::size_t i = 0; i < starting.size() && i < ending.size(); ++i)
    following[starting[i].second] = ending[i].second;

  std::vector<BoundaryLoop> loops;
  std::vector<char> passed(corners.size(), 0);
  std::vector<std::uint32_t> placeOf(mesh.points.size(), kNone); // in the current loop
  for (const std::uint32_t first : open) {
    std::vector<std::uint32_t> way;
    for (std::uint32_t side = first; side != kNone && passed[side] == 0; side = following[side]) {
      passed[side] = 1;
      placeOf[endOf(side)] = static_cast<std::uint32_t>(way.size());
      way.push_back(side);
      const std::uint32_t place = placeOf[startOf(side)];
      if (place == kNone)
        continue;
      BoundaryLoop loop;
      for (std::size_t i = place; i < way.size(); ++i) {
        loop.points.push_back(endOf(way[i]));
        loop.sides.push_back(way[i]);
        placeOf[endOf(way[i])] = kNone;
      }
      way.resize(place);
      if (loop.points.size() > 2)
        loops.push_back(std::move(loop));
    }
  }
  return loops;
}

} // namespace tetvdb
