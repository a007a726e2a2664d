// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// A soup that is being simplified: the faces around each point, the points that may move, and the
/// points of the original that each face carries. Tasks may work at the same time on points of
/// different parts if they change only faces whose three points are of their part.
struct SoupSurface {
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

  /// Carried are the soup's points once they are removed, and from the beginning the midpoints of
  /// edges longer than `spacing`, since new faces may leave an edge between its points.
  SoupSurface(LatticeSoup soup, double spacing);

  /// What is left, in its order.
  LatticeSoup rest() const;

  std::vector<Vec3d> points;
  double grain;                                    ///< as the soup's
  std::vector<std::array<std::uint32_t, 3>> faces; ///< of kNone: gone
  std::vector<std::uint16_t> inputs;               ///< of faces; empty: all of input 0
  std::vector<std::uint32_t> firstCorner;          ///< of a point; kNone: gone
  std::vector<std::uint32_t> nextCorner;           ///< of a corner, 3 * face + k
  std::vector<std::uint8_t> isFixed; ///< points whose faces are not one closed fan of one input,
                                     ///< and those that are asked to stay
  std::vector<std::uint32_t> part;   ///< of a point
  std::vector<std::uint8_t> isDue;   ///< points whose edges are to be tried in the next round

  std::vector<double> depth; ///< of each face: a bound on its distance to the original

  std::vector<Vec3d> carried; ///< the soup's points, then midpoints of edges
  std::vector<std::uint8_t> isCarried;
  std::vector<std::uint32_t> firstCarried, nextCarried; ///< of a face, of a carried point

  bool isGone(std::uint32_t face) const { return faces[face][0] == kNone; }
  std::uint16_t inputOf(std::uint32_t face) const { return inputs.empty() ? 0 : inputs[face]; }

  /// The faces around a point, up to `max` + 1 of them; removed faces are unlinked.
  void findStar(std::uint32_t point, std::size_t max, std::vector<std::uint32_t>& star);
  void link(std::uint32_t point, std::uint32_t corner) {
    nextCorner[corner] = firstCorner[point];
    firstCorner[point] = corner;
  }
  void unlink(std::uint32_t point, std::uint32_t corner);
  void carry(std::uint32_t face, std::uint32_t point) {
    nextCarried[point] = firstCarried[face];
    firstCarried[face] = point;
    isCarried[point] = 1;
  }

private:
  bool isClosedFan(std::uint32_t point) const;
};

} // namespace tetvdb
