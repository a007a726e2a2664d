// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/core/Vec3.h"

#include <array>
#include <cmath>

namespace tetvdb {

/// The solid angle of triangles seen from a distance. A triangle with area vector n seen at q has
/// the integral of n . q / |q|^3: a layer of dipoles. With q = r + y, y relative to the triangles'
/// centre, this is expanded to second order in y.
class DipoleMoments {
public:
  /// Adds a triangle `weight` times; corners are relative to the centre.
  void add(const Vec3d& a, const Vec3d& b, const Vec3d& c, double weight);

  /// The solid angle from a viewpoint that sees the centre at r.
  TETVDB_HD TETVDB_INLINE double angle(const Vec3d& r) const {
    const double x = r[0], y = r[1], z = r[2];
    const double inverse = 1 / std::sqrt(x * x + y * y + z * z);
    const double i2 = inverse * inverse, i3 = i2 * inverse, i5 = i3 * i2;
    const auto& q = quadrupole_;
    const auto& o = octupole_;
    const double square =
        q[0] * x * x + q[1] * y * y + q[2] * z * z + q[3] * x * y + q[4] * x * z + q[5] * y * z;
    const double cube = x * x * (o[0] * x + o[3] * y + o[4] * z) +
                        y * y * (o[1] * y + o[5] * x + o[6] * z) +
                        z * z * (o[2] * z + o[7] * x + o[8] * y) + o[9] * x * y * z;
    const double along = dipole_[0] * x + dipole_[1] * y + dipole_[2] * z;
    const double bent = bent_[0] * x + bent_[1] * y + bent_[2] * z;
    return (along + trace_) * i3 - (3 * square + 1.5 * bent) * i5 + 7.5 * cube * i5 * i2;
  }

private:
  std::array<double, 3> dipole_{};
  double trace_ = 0;
  std::array<double, 6> quadrupole_{}; // xx yy zz xy xz yz
  std::array<double, 3> bent_{};
  std::array<double, 10> octupole_{}; // xxx yyy zzz xxy xxz yyx yyz zzx zzy xyz
};

} // namespace tetvdb
