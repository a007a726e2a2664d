// SPDX-License-Identifier: Apache-2.0
//
// How far a few faces move when they are replaced by others with the same boundary.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Faces that fill a closed boundary, with the edges and points inside.
struct Disc {
  struct Face {
    std::array<Vec3d, 3> at;
    std::array<std::uint32_t, 3>
        numbers;  ///< of its points; points of the boundary have the same in both discs
    double depth; ///< a bound on the distance of its points to a reference surface
  };
  struct Edge {
    Vec3d from, to;
    std::uint32_t a, b; ///< numbers: edges with one in common do not cross
  };
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<Vec3d> points;

  void clear() {
    faces.clear();
    edges.clear();
    points.clear();
  }
};

/// Whether faces around their first corner turn around it once, seen along `direction`: then their
/// boundary is a simple polygon, and any faces with this boundary that all look along `direction`
/// cover it once.
bool goRoundOnce(const Disc& fan, const Vec3d& direction);

/// Of two discs with the same boundary that cover the same polygon once, seen along `direction`:
/// finds depths of the faces of one from those of the other's that they cover, and the distance
/// along `direction` to these. Infinite where a face does not look along `direction`. That distance
/// is linear between the points where it is taken: points of one disc on the other, and crossings
/// of their edges.
class DiscGap {
public:
  void findDepths(const Disc& before, Disc& after, const Vec3d& direction);

private:
  struct Flat {
    std::array<Vec3d, 3> at;
  };
  struct FlatEdge {
    Vec3d from, to;
  };
  std::vector<Flat> old_, made_;
  std::vector<FlatEdge> oldEdges_;
};

} // namespace tetvdb
