// SPDX-License-Identifier: Apache-2.0
//
// How far a few faces move when they are exchanged for others over the same rim.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Faces that fill a rim: with the edges inside, and the points inside.
struct Disc {
  struct Edge {
    Vec3d from, to;
    std::uint32_t a, b; ///< their numbers: edges with one in common do not cross
  };
  std::vector<std::array<Vec3d, 3>> faces;
  std::vector<Edge> edges;
  std::vector<Vec3d> points;

  void clear() {
    faces.clear();
    edges.clear();
    points.clear();
  }
};

/// Whether faces around their first corner go round it once, seen along `direction`: then their rim
/// is a simple polygon, and whatever faces with this rim all look along `direction` cover it once.
bool goRoundOnce(const Disc& fan, const Vec3d& direction);

/// The largest distance along `direction` between two discs with the same rim that both cover the
/// same polygon once: no point of one is farther than that from the other. Infinite where a face
/// does not look along `direction`. The distance is linear between the points where it is taken:
/// points of one disc on the other, and crossings of their edges.
double gapBetween(const Disc& before, const Disc& after, const Vec3d& direction);

} // namespace tetvdb
