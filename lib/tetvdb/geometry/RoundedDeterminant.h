// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/HostDevice.h"

#include <cmath>

namespace tetvdb {

/// The determinant (u x v) . w in doubles, and the scale of its rounding error: the filter of every
/// exact orientation.
struct RoundedDeterminant {
  /// Bounds on the rounding error, relative to `size`. If components are exact, such as
  /// differences of lattice points, each of the six products has 2 roundings of 2^-53 and sums
  /// add 4 more; rounded differences add another 3. Each bound includes the rounding of
  /// `size`.
  static constexpr double kOfExact = 1e-15, kOfRounded = 16 * 0x1p-53;

  double value, size; ///< size: the sum of the products' absolute values

  TETVDB_HD RoundedDeterminant(double ux, double uy, double uz, double vx, double vy, double vz,
                               double wx, double wy, double wz) {
    const double yz = uy * vz, zy = uz * vy, zx = uz * vx, xz = ux * vz, xy = ux * vy, yx = uy * vx;
    value = wx * (yz - zy) + wy * (zx - xz) + wz * (xy - yx);
    size = std::abs(wx) * (std::abs(yz) + std::abs(zy)) +
           std::abs(wy) * (std::abs(zx) + std::abs(xz)) +
           std::abs(wz) * (std::abs(xy) + std::abs(yx));
  }

  /// The exact sign, or 0 if the rounding error may exceed the value.
  TETVDB_HD int sign(double error) const {
    return value > error * size ? 1 : value < -error * size ? -1 : 0;
  }
};

} // namespace tetvdb
