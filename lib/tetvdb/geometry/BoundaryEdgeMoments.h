// SPDX-License-Identifier: Apache-2.0
//
// Clusters of boundary edges seen from a distance. With the cluster's centre c, the spherical
// triangle (a, b, up) of an edge is the sum of (a, b, c), (c, b, up) and (a, c, up). The first form
// a cone, which DipoleMoments sums. The others cancel except at points where the cluster cuts a
// boundary loop, and are expanded here, in coordinates relative to c.
#pragma once

#include "tetvdb/core/Multiversion.h"
#include "tetvdb/core/Vec3.h"

#include <array>
#include <cmath>

namespace tetvdb {

/// Triangles (centre, open end, up).
///
/// With r from the viewpoint to a point of the edge, d(angle) = (r x dr)_z g(r), where g = 1 /
/// (|r| (|r| + r.z)): the vector potential of a monopole with its string upward. From the centre
/// to an open end at y, this is (r x y)_z times the mean of g along the segment, here to third
/// order in y: for viewpoints several |y| away from the centre and from the upward ray that begins
/// there.
class EndMoments {
public:
  /// y: relative to the centre.
  void add(const Vec3d& y, double weight);

  /// The sum of the solid angles from a viewpoint that sees the centre at r.
  TETVDB_INLINE double angle(const Vec3d& r) const {
    const double x = r[0], y = r[1], z = r[2];
    const double length = std::sqrt(x * x + y * y + z * z);
    const double inverse = 1 / length;
    const double nx = x * inverse, ny = y * inverse, nz = z * inverse;
    const double g = 1 / (length * (length + z));
    // Derivatives of 1 / g divided by 1 / g.
    const double zi = z * inverse;
    const double dx = (2 * x + z * nx) * g, dy = (2 * y + z * ny) * g,
                 dz = (2 * z + z * nz + length) * g;
    const double xx = 2 * dx * dx - (2 + zi * (1 - nx * nx)) * g,
                 yy = 2 * dy * dy - (2 + zi * (1 - ny * ny)) * g,
                 zz = 2 * dz * dz - (2 + zi * (1 - nz * nz) + 2 * nz) * g,
                 xy = 2 * dx * dy + zi * nx * ny * g, xz = 2 * dx * dz - (nx - zi * nx * nz) * g,
                 yz = 2 * dy * dz - (ny - zi * ny * nz) * g;
    const auto& f = first_;
    const auto& s = second_;
    const auto& t = third_;
    const double sumX = f[0] - (dx * s[0] + dy * s[1] + dz * s[3]) / 2 +
                        (xx * t[0] + yy * t[2] + zz * t[7]) / 6 +
                        (xy * t[1] + xz * t[4] + yz * t[5]) / 3;
    const double sumY = f[1] - (dx * s[1] + dy * s[2] + dz * s[4]) / 2 +
                        (xx * t[1] + yy * t[3] + zz * t[8]) / 6 +
                        (xy * t[2] + xz * t[5] + yz * t[6]) / 3;
    return (x * sumY - y * sumX) * g;
  }

private:
  std::array<double, 2> first_{};  // x y
  std::array<double, 5> second_{}; // xx xy yy zx zy
  std::array<double, 9> third_{};  // xxx xxy xyy yyy zxx zxy zyy zzx zzy
};

} // namespace tetvdb
