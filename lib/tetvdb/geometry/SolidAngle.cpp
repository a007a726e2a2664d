// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/SolidAngle.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/AddUnlessNaN.h"
#include "tetvdb/geometry/BoundaryEdgeSums.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/TriangleAngle.h"
#include "tetvdb/geometry/VectorMath.h"

#include <cmath>

namespace tetvdb {
namespace {

// Whether 0, moved, is in front of the plane of a triangle that is not vertical: on the side of its
// normal.
bool isInFront(const SeenTriangle& t) {
  if (const int side = orientation(t.a, t.b, t.c, Vec3d{0, 0, 0}); side != 0)
    return side > 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3d moved{0, 0, 0};
    moved[axis] = 1;
    if (const int side = orientation(t.a, t.b, t.c, moved); side != 0)
      return side > 0;
  }
  return false;
}

TETVDB_MULTIVERSION
void anglesAtPoints(const SeenTriangle& t, double weight, const double* x, const double* y,
                    const double* z, std::size_t n, double* __restrict out) {
  const double ax = t.a[0], ay = t.a[1], az = t.a[2], bx = t.b[0], by = t.b[1], bz = t.b[2],
               cx = t.c[0], cy = t.c[1], cz = t.c[2];
  for (std::size_t i = 0; i < n; ++i)
    out[i] = weightedAngle(ax - x[i], ay - y[i], az - z[i], bx - x[i], by - y[i], bz - z[i],
                           cx - x[i], cy - y[i], cz - z[i], weight);
}

TETVDB_MULTIVERSION
void addAnglesOfFloats(const SeenTriangle& t, float weight, double scale, const double* x,
                       const double* y, const double* z, std::size_t n, double* __restrict sum) {
  float px[kMaxPointSums], py[kMaxPointSums], pz[kMaxPointSums], angles[kMaxPointSums];
  for (std::size_t i = 0; i < n; ++i) {
    px[i] = static_cast<float>((t.a[0] - x[i]) * scale);
    py[i] = static_cast<float>((t.a[1] - y[i]) * scale);
    pz[i] = static_cast<float>((t.a[2] - z[i]) * scale);
  }
  const FloatTriangle triangle(t, weight, scale);
  for (std::size_t i = 0; i < n; ++i)
    angles[i] = triangle.angle(px[i], py[i], pz[i]);
  for (std::size_t i = 0; i < n; ++i)
    sum[i] += static_cast<double>(angles[i]);
}

} // namespace

std::int32_t crossingBelow(const SeenTriangle& t) {
  const double ab = turn(t.a, t.b), bc = turn(t.b, t.c), ca = turn(t.c, t.a);
  const bool looksUp = ab > 0 && bc > 0 && ca > 0, looksDown = ab < 0 && bc < 0 && ca < 0;
  if (!looksUp && !looksDown)
    return 0;
  const bool below = (t.a[2] < 0 && t.b[2] < 0 && t.c[2] < 0) ||
                     (!(t.a[2] > 0 && t.b[2] > 0 && t.c[2] > 0) && isInFront(t) == looksUp);
  return below ? (looksDown ? 1 : -1) : 0;
}

// Two kinds of triangles are added: the triangle itself, and those that connect its edges with the
// upward direction, which close it except below.
double solidAngle(const SeenTriangle& t) {
  return 4 * kPi * crossingBelow(t) + angleUp(t.a, t.b) + angleUp(t.b, t.c) + angleUp(t.c, t.a);
}

void addSolidAngles(const SeenTriangle& t, double weight, const PointSums& points) {
  double angles[kMaxPointSums];
  anglesAtPoints(t, weight, points.x, points.y, points.z, points.count, angles);
  if (addUnlessNaN(points.sum, angles, points.count))
    return;
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3d p{points.x[i], points.y[i], points.z[i]};
    points.sum[i] += std::isnan(angles[i])
                         ? weight * solidAngle({minus(t.a, p), minus(t.b, p), minus(t.c, p)})
                         : angles[i];
  }
}

void addFarSolidAngles(const SeenTriangle& t, double weight, double unit, const PointSums& points) {
  addAnglesOfFloats(t, static_cast<float>(weight), 1 / unit, points.x, points.y, points.z,
                    points.count, points.sum);
}

} // namespace tetvdb
