// SPDX-License-Identifier: Apache-2.0
//
// Winding numbers of open meshes by one ray. A curtain from the boundary edges to infinity upward
// closes the mesh, so that the winding number of both equals the signed crossings of a downward
// ray. The ray crosses the mesh only, since it is parallel to the curtain. The curtain's share is
// subtracted.
#pragma once

#include "tetvdb/core/Constants.h"
#include "tetvdb/geometry/VectorMath.h"

#include <cmath>

namespace tetvdb {

/// Of length 1, in a direction that is unlikely for faces.
inline const Vec3d kCurtainUp = [] {
  const Vec3d way{0.2612, 0.4135, 0.8722};
  return times(way, 1 / length(way));
}();

/// An edge that faces traverse `weight` times more often from a to b than from b to a.
struct CurtainEdge {
  Vec3d a, b;
  double weight;
};

/// Half the solid angle at p of the triangle from a to b to infinity along kCurtainUp (van Oosterom
/// and Strackee 1983, divided by the third corner's distance).
inline double halfCurtainAngle(const CurtainEdge& edge, const Vec3d& p) {
  const Vec3d a = minus(edge.a, p), b = minus(edge.b, p);
  const double la = length(a), lb = length(b);
  const double above = dot(cross(a, b), kCurtainUp);
  const double below = la * lb + dot(a, b) + dot(b, kCurtainUp) * la + dot(a, kCurtainUp) * lb;
  return std::atan2(above, below);
}

/// The winding number of a solid angle, given by its half: `weight` times the angle over 4 pi.
inline double curtainWinding(double weight, double halfAngle) {
  return weight * halfAngle / (2 * kPi);
}

/// Is added to the signed crossings of the downward ray from p.
inline double curtainWinding(const CurtainEdge& edge, const Vec3d& p) {
  return curtainWinding(edge.weight, halfCurtainAngle(edge, p));
}

} // namespace tetvdb
