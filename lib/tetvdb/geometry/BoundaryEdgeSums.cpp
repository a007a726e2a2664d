// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/BoundaryEdgeSums.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/AddUnlessNaN.h"
#include "tetvdb/geometry/ArcTangent.h"
#include "tetvdb/geometry/Exact.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetvdb {
namespace {

// Above this share of their sizes, a difference of two rounded products has the correct sign.
constexpr double kSure = 4.5e-16;

// a.x b.y - a.y b.x: exact in its sign and for zero.
double exactTurn(const Vec3d& a, const Vec3d& b) {
  const double left = a[0] * b[1], right = a[1] * b[0];
  const double difference = left - right;
  if (std::abs(difference) > kSure * (std::abs(left) + std::abs(right)))
    return difference;
  return static_cast<double>(
      static_cast<Int128>(static_cast<std::int64_t>(a[0])) * static_cast<std::int64_t>(b[1]) -
      static_cast<Int128>(static_cast<std::int64_t>(a[1])) * static_cast<std::int64_t>(b[0]));
}

// A negligible number with the sign of `first`, or of `second` if that is zero.
double signOfFirst(double first, double second) {
  const double leading = first != 0 ? first : second;
  return leading == 0 ? 0.0 : std::copysign(std::numeric_limits<double>::min(), leading);
}

// |a| + a.z, without cancellation.
double above(const Vec3d& a) {
  const double flat = a[0] * a[0] + a[1] * a[1];
  const double length = std::sqrt(flat + a[2] * a[2]);
  return a[2] < 0 ? flat / (length - a[2]) : length + a[2];
}

// angleUp() for an end point a vertically below the viewpoint. Moved by (e, e^2, e^3), the
// viewpoint sees a in direction (-e, -e^2) from the pole: a lune from there to b.
double angleFromPole(const Vec3d& b) {
  const double sine = b[1] != 0 ? -b[1] : std::copysign(0.0, b[0]);
  return 2 * std::atan2(sine, -b[0]);
}

bool isZero(const Vec3d& a) {
  return a[0] == 0 && a[1] == 0 && a[2] == 0;
}

// Whether the viewpoint lies on the open segment between a and b.
bool isBetween(const Vec3d& a, const Vec3d& b) {
  if (dot(a, b) >= 0)
    return false;
  const auto product = [&](std::size_t i, std::size_t j) {
    return static_cast<Int128>(static_cast<std::int64_t>(a[i])) * static_cast<std::int64_t>(b[j]);
  };
  return product(0, 1) == product(1, 0) && product(1, 2) == product(2, 1) &&
         product(2, 0) == product(0, 2);
}

// angleUp() for a viewpoint on the edge from a to b: moved by (e, e^2, e^3), it sees the edge as
// half a great circle through the direction back, and up is at an angle to that half plane.
double angleOnEdge(const Vec3d& a, const Vec3d& b) {
  Vec3d t{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const double way = length(t);
  for (double& c : t)
    c /= way;
  const bool alongX = t[1] == 0 && t[2] == 0;
  const Vec3d moved = alongX ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
  Vec3d back{0, 0, 0}, up{0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    back[k] = dot(moved, t) * t[k] - moved[k];
    up[k] = (k == 2 ? 1.0 : 0.0) - t[2] * t[k];
  }
  // With t = (x, 0, z), up lies in the plane of edge and back; the sign is that of the e^2 term.
  const double sine = t[1] == 0 && !alongX ? std::copysign(0.0, -t[0]) : dot(t, cross(back, up));
  return -2 * std::atan2(sine, dot(back, up));
}

// Number of edges per iteration of a loop, and of its partial sums.
constexpr std::size_t kBlock = 64;
constexpr std::size_t kLanes = 8;

BoundaryEdgeView from(const BoundaryEdgeView& edges, std::size_t i) {
  return {edges.ax + i, edges.ay + i, edges.az + i,    edges.bx + i,
          edges.by + i, edges.bz + i, edges.weight + i};
}

// weight * angleUp(); NaN if angleUp() itself is required. above(a) is a fraction na / da, so that
// only the division of the tangent remains: divisions and square roots dominate the time of this
// loop.
TETVDB_INLINE double weightedAngle(double ax, double ay, double az, double bx, double by, double bz,
                                   double weight) {
  const double fa = ax * ax + ay * ay, fb = bx * bx + by * by;
  const double la = std::sqrt(fa + az * az), lb = std::sqrt(fb + bz * bz);
  const double na = az < 0 ? fa : la + az, da = az < 0 ? la - az : 1.0;
  const double nb = bz < 0 ? fb : lb + bz, db = bz < 0 ? lb - bz : 1.0;
  const double below = da * db;
  const double left = ax * by, right = ay * bx;
  const double sine = left - right;
  const double flat = ax * bx + ay * by;
  const double cosine = na * nb + flat * below;
  const double tangent = sine * below;
  const double angle = arcTangent(tangent, cosine);
  const bool sure =
      std::abs(sine) > kSure * (std::abs(left) + std::abs(right)) &&
      (std::abs(tangent) + std::abs(cosine) > 1e-9 * la * lb * below || flat + az * bz > 0);
  return sure ? 2 * weight * angle : std::numeric_limits<double>::quiet_NaN();
}

// n edges, seen from one point.
TETVDB_MULTIVERSION
void anglesOfEdges(BoundaryEdgeView e, std::size_t n, double px, double py, double pz,
                   double* __restrict out) {
  for (std::size_t i = 0; i < n; ++i)
    out[i] = weightedAngle(e.ax[i] - px, e.ay[i] - py, e.az[i] - pz, e.bx[i] - px, e.by[i] - py,
                           e.bz[i] - pz, e.weight[i]);
}

// One edge, seen from n points.
TETVDB_MULTIVERSION
void anglesAtPoints(LatticePoint a, LatticePoint b, double weight, const double* x, const double* y,
                    const double* z, std::size_t n, double* __restrict out) {
  for (std::size_t i = 0; i < n; ++i)
    out[i] = weightedAngle(a.x - x[i], a.y - y[i], a.z - z[i], b.x - x[i], b.y - y[i], b.z - z[i],
                           weight);
}

// Field of a straight current from a to b, seen from 0: a x b (|a| + |b|) / (|a||b| (|a||b| +
// a.b)), negative.
TETVDB_MULTIVERSION
void fields(BoundaryEdgeView e, std::size_t n, double px, double py, double pz,
            double* __restrict x, double* __restrict y, double* __restrict z) {
  for (std::size_t i = 0; i < n; ++i) {
    const double ax = e.ax[i] - px, ay = e.ay[i] - py, az = e.az[i] - pz;
    const double bx = e.bx[i] - px, by = e.by[i] - py, bz = e.bz[i] - pz;
    const double la = std::sqrt(ax * ax + ay * ay + az * az);
    const double lb = std::sqrt(bx * bx + by * by + bz * bz);
    const double below = la * lb * (la * lb + (ax * bx + ay * by + az * bz));
    const double factor = below > 0 ? e.weight[i] * (la + lb) / below : 0.0;
    x[i] = factor * (ay * bz - az * by);
    y[i] = factor * (az * bx - ax * bz);
    z[i] = factor * (ax * by - ay * bx);
  }
}

TETVDB_MULTIVERSION
void bends(BoundaryEdgeView e, std::size_t n, double px, double py, double pz, double reach,
           double* __restrict out) {
  for (std::size_t i = 0; i < n; ++i) {
    const double x = e.bx[i] - e.ax[i], y = e.by[i] - e.ay[i], z = e.bz[i] - e.az[i];
    const double u = px - e.ax[i], v = py - e.ay[i], w = pz - e.az[i];
    const double square = x * x + y * y + z * z;
    double t = (x * u + y * v + z * w) / (square > 0 ? square : 1.0);
    t = t > 0 ? t : 0.0;
    t = t < 1 ? t : 1.0;
    const double dx = u - t * x, dy = v - t * y, dz = w - t * z;
    const double d = std::sqrt(dx * dx + dy * dy + dz * dz) - reach;
    const double shortEdge = 2 * std::sqrt(square) / (d * d * d), longEdge = 4 / (d * d);
    const double bend = std::abs(e.weight[i]) * (shortEdge < longEdge ? shortEdge : longEdge);
    out[i] = d > 0 ? bend : std::numeric_limits<double>::infinity();
  }
}

double sumOf(const double* values, std::size_t n) {
  double lanes[kLanes] = {};
  for (std::size_t i = 0; i < n; ++i)
    lanes[i % kLanes] += values[i];
  double sum = 0;
  for (const double lane : lanes)
    sum += lane;
  return sum;
}

} // namespace

void BoundaryEdgeArrays::push(const LatticePoint& a, const LatticePoint& b, double w) {
  ax.push_back(a.x);
  ay.push_back(a.y);
  az.push_back(a.z);
  bx.push_back(b.x);
  by.push_back(b.y);
  bz.push_back(b.z);
  weight.push_back(w);
}

double turn(const Vec3d& a, const Vec3d& b) {
  const double value = exactTurn(a, b);
  // (a.x - e)(b.y - e^2) - (a.y - e^2)(b.x - e): the terms of first order in e, then in e^2.
  return value != 0 ? value : signOfFirst(a[1] - b[1], b[0] - a[0]);
}

// Van Oosterom and Strackee 1983, with one corner at infinity: the tangent of half the angle is
// det(a, b, up) over |a||b| + a.b + |b| a.z + |a| b.z = (|a| + a.z)(|b| + b.z) + a.x b.x + a.y b.y.
double angleUp(const Vec3d& a, const Vec3d& b) {
  if (isZero(a)) // from (e, e^2, e^3), the end point is in direction -x
    return isZero(b) ? 0.0 : angleUp({-1, 0, 0}, b);
  if (isZero(b))
    return -angleUp({-1, 0, 0}, a);
  const double sine = turn(a, b);
  if (sine == 0)
    return 0; // a vertical edge has no curtain
  if (a[0] == 0 && a[1] == 0)
    return a[2] < 0 ? angleFromPole(b) : 0.0;
  if (b[0] == 0 && b[1] == 0)
    return b[2] < 0 ? -angleFromPole(a) : 0.0;
  const double cosine = (above(a) * above(b)) + (a[0] * b[0] + a[1] * b[1]);
  if (std::abs(sine) + std::abs(cosine) < 1e-9 * length(a) * length(b) && isBetween(a, b))
    return angleOnEdge(a, b);
  return 2 * std::atan2(sine, cosine);
}

double sumAngles(BoundaryEdgeView edges, std::size_t begin, std::size_t end,
                 const LatticePoint& p) {
  double angles[kBlock];
  double sum = 0;
  for (std::size_t i = begin; i < end; i += kBlock) {
    const std::size_t n = std::min(kBlock, end - i);
    anglesOfEdges(from(edges, i), n, p.x, p.y, p.z, angles);
    for (std::size_t k = 0; k < n; ++k)
      if (std::isnan(angles[k])) {
        const std::size_t e = i + k;
        angles[k] =
            edges.weight[e] * angleUp({edges.ax[e] - p.x, edges.ay[e] - p.y, edges.az[e] - p.z},
                                      {edges.bx[e] - p.x, edges.by[e] - p.y, edges.bz[e] - p.z});
      }
    sum += sumOf(angles, n);
  }
  return sum;
}

void addAngles(const LatticePoint& a, const LatticePoint& b, double weight, BoundaryPoints& points,
               std::vector<double>& scratch) {
  const std::size_t n = points.size();
  anglesAtPoints(a, b, weight, points.x.data(), points.y.data(), points.z.data(), n,
                 scratch.data());
  if (addUnlessNaN(points.sum.data(), scratch.data(), n))
    return;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = points.x[i], y = points.y[i], z = points.z[i];
    points.sum[i] += std::isnan(scratch[i]) ? weight * angleUp({a.x - x, a.y - y, a.z - z},
                                                               {b.x - x, b.y - y, b.z - z})
                                            : scratch[i];
  }
}

Vec3d sumField(BoundaryEdgeView edges, std::size_t begin, std::size_t end, const LatticePoint& p) {
  double x[kBlock], y[kBlock], z[kBlock];
  Vec3d sum{0, 0, 0};
  for (std::size_t i = begin; i < end; i += kBlock) {
    const std::size_t n = std::min(kBlock, end - i);
    fields(from(edges, i), n, p.x, p.y, p.z, x, y, z);
    sum = {sum[0] + sumOf(x, n), sum[1] + sumOf(y, n), sum[2] + sumOf(z, n)};
  }
  return sum;
}

double sumBend(BoundaryEdgeView edges, std::size_t begin, std::size_t end, const LatticePoint& p,
               double reach) {
  double bend[kBlock];
  double sum = 0;
  for (std::size_t i = begin; i < end && std::isfinite(sum); i += kBlock) {
    const std::size_t n = std::min(kBlock, end - i);
    bends(from(edges, i), n, p.x, p.y, p.z, reach, bend);
    sum += sumOf(bend, n);
  }
  return sum;
}

} // namespace tetvdb
