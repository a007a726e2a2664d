// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/HostDevice.h"

#include <cmath>

namespace tetvdb {

/// The determinant (u x v) . w in doubles, and what its rounding is relative to: the filter before
/// every exact orientation.
struct RoundedDeterminant {
  /// Bounds on the rounding, relative to `size`. Where components are exact, as differences of
  /// lattice points are, each of the six products is off by 2 roundings of 2^-53 and sums add 4
  /// more; of differences that are rounded themselves another 3, each bound with room for the
  /// rounding of `size`.
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

  /// The exact sign, or 0 where rounding may hide it.
  TETVDB_HD int sign(double error) const {
    return value > error * size ? 1 : value < -error * size ? -1 : 0;
  }
};

} // namespace tetvdb
