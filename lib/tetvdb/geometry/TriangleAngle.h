// SPDX-License-Identifier: Apache-2.0
//
// The solid angle of one triangle, without branches: the innermost part of SolidAngle.h. The same
// source, with the same bits, is used on the CPU, vectorised, and on a GPU.
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/ArcTangent.h"
#include "tetvdb/geometry/SolidAngle.h"

#include <cmath>
#include <limits>

namespace tetvdb {

/// Above this share of the product of the three lengths, the determinant has the correct sign.
constexpr double kSureSine = 1e-14;
/// Sine and cosine are accurate unless both are below this share.
constexpr double kSmallSine = 1e-6;

/// weight * the solid angle; NaN if solidAngle() is required. Van Oosterom and Strackee 1983:
/// the tangent of half the angle is det(a, b, c) over |a||b||c| + a.b |c| + b.c |a| + c.a
/// |b|.
TETVDB_HD TETVDB_INLINE double weightedAngle(double ax, double ay, double az, double bx, double by,
                                             double bz, double cx, double cy, double cz,
                                             double weight) {
  const double la = std::sqrt(ax * ax + ay * ay + az * az);
  const double lb = std::sqrt(bx * bx + by * by + bz * bz);
  const double lc = std::sqrt(cx * cx + cy * cy + cz * cz);
  const double sine =
      ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
  const double product = la * lb * lc;
  const double cosine = product + (ax * bx + ay * by + az * bz) * lc +
                        (bx * cx + by * cy + bz * cz) * la + (cx * ax + cy * ay + cz * az) * lb;
  const bool sure = (std::abs(sine) > kSureSine * product || cosine > 0) &&
                    std::abs(sine) + std::abs(cosine) > kSmallSine * product;
  return sure ? 2 * weight * arcTangent(sine, cosine) : std::numeric_limits<double>::quiet_NaN();
}

/// arcTangent() within 2e-7, with the series to float precision.
TETVDB_HD TETVDB_INLINE float arcTangentOfFloats(float sine, float cosine) {
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

/// A triangle in single precision, relative to its first corner.
struct FloatTriangle {
  float bx, by, bz, cx, cy, cz, nx, ny, nz, weight;

  TETVDB_HD TETVDB_INLINE FloatTriangle(const SeenTriangle& t, float times, double scale)
      : bx(static_cast<float>((t.b[0] - t.a[0]) * scale)),
        by(static_cast<float>((t.b[1] - t.a[1]) * scale)),
        bz(static_cast<float>((t.b[2] - t.a[2]) * scale)),
        cx(static_cast<float>((t.c[0] - t.a[0]) * scale)),
        cy(static_cast<float>((t.c[1] - t.a[1]) * scale)),
        cz(static_cast<float>((t.c[2] - t.a[2]) * scale)), nx(by * cz - bz * cy),
        ny(bz * cx - bx * cz), nz(bx * cy - by * cx), weight(times) {}

  /// weight * the solid angle from where the first corner is seen at u.
  TETVDB_HD TETVDB_INLINE float angle(float ux, float uy, float uz) const {
    const float vx = ux + bx, vy = uy + by, vz = uz + bz, wx = ux + cx, wy = uy + cy, wz = uz + cz;
    const float u = std::sqrt(ux * ux + uy * uy + uz * uz);
    const float v = std::sqrt(vx * vx + vy * vy + vz * vz);
    const float w = std::sqrt(wx * wx + wy * wy + wz * wz);
    const float sine = ux * nx + uy * ny + uz * nz;
    const float cosine = u * v * w + (ux * vx + uy * vy + uz * vz) * w +
                         (vx * wx + vy * wy + vz * wz) * u + (wx * ux + wy * uy + wz * uz) * v;
    return 2 * weight * arcTangentOfFloats(sine, cosine);
  }
};

} // namespace tetvdb
