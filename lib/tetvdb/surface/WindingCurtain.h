// SPDX-License-Identifier: Apache-2.0
//
// Winding numbers of open meshes by one ray: a mesh and a curtain that stands on its boundary edges
// and goes up to infinity are closed together, so that their winding number is what a ray downwards
// crosses, of the mesh alone since it runs along the curtain. What the curtain adds is taken off.
#pragma once

#include "tetvdb/geometry/VectorMath.h"

#include <cmath>

namespace tetvdb {

/// Of length 1, along nothing that meshes are usually built along.
inline const Vec3d kCurtainUp = [] {
  const Vec3d way{0.2612, 0.4135, 0.8722};
  return times(way, 1 / length(way));
}();

/// An edge that faces run along `weight` times more often from a to b than from b to a.
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

/// The solid angle whose half is `halfAngle`, over 4 pi, `weight` times.
inline double curtainWinding(double weight, double halfAngle) {
  constexpr double kPi = 3.14159265358979323846;
  return weight * halfAngle / (2 * kPi);
}

/// To be added to the signed crossings of the ray from p downwards.
inline double curtainWinding(const CurtainEdge& edge, const Vec3d& p) {
  return curtainWinding(edge.weight, halfCurtainAngle(edge, p));
}

} // namespace tetvdb
