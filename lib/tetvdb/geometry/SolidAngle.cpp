// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/SolidAngle.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/AddUnlessNaN.h"
#include "tetvdb/geometry/ArcTangent.h"
#include "tetvdb/geometry/BoundaryEdgeSums.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/VectorMath.h"

#include <cmath>
#include <limits>

namespace tetvdb {
namespace {

// Above this share of the product of the three lengths, the determinant has the correct sign.
constexpr double kSure = 1e-14;
// Sine and cosine are accurate unless both are below this share.
constexpr double kSmall = 1e-6;

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

// weight * the solid angle; NaN if solidAngle() is required. Van Oosterom and Strackee 1983:
// the tangent of half the angle is det(a, b, c) over |a||b||c| + a.b |c| + b.c |a| + c.a
// |b|.
TETVDB_INLINE double weightedAngle(double ax, double ay, double az, double bx, double by, double bz,
                                   double cx, double cy, double cz, double weight) {
  const double la = std::sqrt(ax * ax + ay * ay + az * az);
  const double lb = std::sqrt(bx * bx + by * by + bz * bz);
  const double lc = std::sqrt(cx * cx + cy * cy + cz * cz);
  const double sine =
      ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
  const double product = la * lb * lc;
  const double cosine = product + (ax * bx + ay * by + az * bz) * lc +
                        (bx * cx + by * cy + bz * cz) * la + (cx * ax + cy * ay + cz * az) * lb;
  const bool sure = (std::abs(sine) > kSure * product || cosine > 0) &&
                    std::abs(sine) + std::abs(cosine) > kSmall * product;
  return sure ? 2 * weight * arcTangent(sine, cosine) : std::numeric_limits<double>::quiet_NaN();
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

// arcTangent() within 2e-7, with the series to float precision.
TETVDB_INLINE float arcTangentOfFloats(float sine, float cosine) {
  const float y = std::abs(sine), x = std::abs(cosine);
  const float low = y < x ? y : x, high = y < x ? x : y;
  const bool steep = low > 0.41421356f * high;
  const float u = (steep ? low - high : low) / (steep ? low + high : high);
  const float v = u * u;
  const float series =
      1.0f -
      v * (1.0f / 3 -
           v * (1.0f / 5 - v * (1.0f / 7 - v * (1.0f / 9 - v * (1.0f / 11 - v * (1.0f / 13))))));
  float angle = (steep ? 0.78539816f : 0.0f) + u * series;
  angle = y < x ? angle : 1.57079633f - angle;
  angle = cosine < 0 ? 3.14159265f - angle : angle;
  return sine < 0 ? -angle : angle;
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
  const auto bx = static_cast<float>((t.b[0] - t.a[0]) * scale),
             by = static_cast<float>((t.b[1] - t.a[1]) * scale),
             bz = static_cast<float>((t.b[2] - t.a[2]) * scale),
             cx = static_cast<float>((t.c[0] - t.a[0]) * scale),
             cy = static_cast<float>((t.c[1] - t.a[1]) * scale),
             cz = static_cast<float>((t.c[2] - t.a[2]) * scale);
  const float nx = by * cz - bz * cy, ny = bz * cx - bx * cz, nz = bx * cy - by * cx;
  for (std::size_t i = 0; i < n; ++i) {
    const float ux = px[i], uy = py[i], uz = pz[i];
    const float vx = ux + bx, vy = uy + by, vz = uz + bz, wx = ux + cx, wy = uy + cy, wz = uz + cz;
    const float u = std::sqrt(ux * ux + uy * uy + uz * uz);
    const float v = std::sqrt(vx * vx + vy * vy + vz * vz);
    const float w = std::sqrt(wx * wx + wy * wy + wz * wz);
    const float sine = ux * nx + uy * ny + uz * nz;
    const float cosine = u * v * w + (ux * vx + uy * vy + uz * vz) * w +
                         (vx * wx + vy * wy + vz * wz) * u + (wx * ux + wy * uy + wz * uz) * v;
    angles[i] = 2 * weight * arcTangentOfFloats(sine, cosine);
  }
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
