// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/TetEnergy.h"

#include "tetvdb/geometry/Exact.h"

#include <cstdint>

namespace tetvdb {

double exactDeterminant(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  // Differences have 38 bits and a sign: 117 bits for the sum of six products.
  const auto difference = [&](const Vec3d& p, std::size_t axis) {
    return static_cast<Int128>(static_cast<std::int64_t>(p[axis] - a[axis]));
  };
  const Int128 ux = difference(b, 0), uy = difference(b, 1), uz = difference(b, 2);
  const Int128 vx = difference(c, 0), vy = difference(c, 1), vz = difference(c, 2);
  const Int128 wx = difference(d, 0), wy = difference(d, 1), wz = difference(d, 2);
  return static_cast<double>(wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) +
                             wz * (ux * vy - uy * vx));
}

} // namespace tetvdb
