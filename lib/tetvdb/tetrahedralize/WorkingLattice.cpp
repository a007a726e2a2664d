// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/WorkingLattice.h"

#include <algorithm>
#include <array>

namespace tetvdb {

WorkingLattice::WorkingLattice(const Box& box) {
  double side = 0, far = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    side = std::max(side, box.high[axis] - box.low[axis]);
    far = std::max({far, std::abs(box.low[axis]), std::abs(box.high[axis])});
  }
  // Coordinates reach to one side from the centre, margin included: 2^37 with 37 bits a side. World
  // coordinates need 53 bits at most, up to twice as far out.
  int sideBits = 0, farBits = 0;
  std::frexp(std::max(side, 1e-300), &sideBits);
  std::frexp(std::max(2 * (far + side), 1e-300), &farBits);
  unit_ = std::ldexp(1.0, std::max(sideBits - 37, farBits - 52));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double centre = box.low[axis] / 2 + box.high[axis] / 2;
    origin_[axis] = std::nearbyint(centre / unit_) * unit_;
  }
}

Vec3d WorkingLattice::toLattice(const Vec3d& world) const {
  return roundToLattice({(world[0] - origin_[0]) / unit_, (world[1] - origin_[1]) / unit_,
                         (world[2] - origin_[2]) / unit_});
}

Vec3d WorkingLattice::toWorld(const Vec3d& lattice) const {
  return {origin_[0] + lattice[0] * unit_, origin_[1] + lattice[1] * unit_,
          origin_[2] + lattice[2] * unit_};
}

Int128 exactDeterminant(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  // Differences have 38 bits and a sign: 114 bits for a product, 117 for the sum of six.
  const auto difference = [&](const Vec3d& p, std::size_t axis) {
    return static_cast<Int128>(static_cast<std::int64_t>(p[axis] - a[axis]));
  };
  const Int128 ux = difference(b, 0), uy = difference(b, 1), uz = difference(b, 2);
  const Int128 vx = difference(c, 0), vy = difference(c, 1), vz = difference(c, 2);
  const Int128 wx = difference(d, 0), wy = difference(d, 1), wz = difference(d, 2);
  return wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx);
}

} // namespace tetvdb
