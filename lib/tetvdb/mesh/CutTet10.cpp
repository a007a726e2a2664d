// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/CutTet10.h"

#include "tetvdb/mesh/SplitPolyhedron.h"

namespace tetvdb {

std::array<std::array<std::uint8_t, 4>, 8> cutTet10(const std::uint32_t* nodes,
                                                    const std::vector<Vec3d>& points) {
  // A corner with the mids of its edges, in the order that keeps the cell's orientation; then the
  // rings of mids around the three diagonals, turned so that (from, to, ring, ring) is positive.
  static constexpr std::array<std::array<std::uint8_t, 4>, 4> kCorners = {
      {{0, 4, 6, 7}, {1, 5, 4, 8}, {2, 6, 5, 9}, {3, 7, 9, 8}}};
  static constexpr std::uint8_t kEnds[3][2] = {{4, 9}, {5, 7}, {6, 8}};
  static constexpr std::uint8_t kRings[3][4] = {{5, 6, 7, 8}, {4, 8, 9, 6}, {4, 5, 9, 7}};

  // Of equally short ones the one whose first point comes first by position.
  std::size_t diagonal = 0;
  double shortest = 0;
  std::uint32_t shortestFirst = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::uint32_t a = nodes[kEnds[d][0]], b = nodes[kEnds[d][1]];
    double length = 0;
    for (std::size_t k = 0; k < 3; ++k)
      length += (points[a][k] - points[b][k]) * (points[a][k] - points[b][k]);
    const std::uint32_t first = isBefore(points.data(), a, b) ? a : b;
    if (d > 0 && (length > shortest ||
                  (length == shortest && !isBefore(points.data(), first, shortestFirst))))
      continue;
    diagonal = d;
    shortest = length;
    shortestFirst = first;
  }
  std::array<std::array<std::uint8_t, 4>, 8> tets{};
  for (std::size_t i = 0; i < 4; ++i) {
    tets[i] = kCorners[i];
    tets[4 + i] = {kEnds[diagonal][0], kEnds[diagonal][1], kRings[diagonal][i],
                   kRings[diagonal][(i + 1) % 4]};
  }
  return tets;
}

} // namespace tetvdb
