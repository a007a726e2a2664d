// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include "tetvdb/geometry/WideInteger.h"

#include <algorithm>
#include <array>

namespace tetvdb {

WorkingLattice::WorkingLattice(const Box& box) {
  double side = 0, far = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    side = std::max(side, box.high[axis] - box.low[axis]);
    far = std::max({far, std::abs(box.low[axis]), std::abs(box.high[axis])});
  }
  // Coordinates reach to one side from the centre, margin included: 2^47 with 47 bits a side. World
  // coordinates need 53 bits at most, up to twice as far out.
  int sideBits = 0, farBits = 0;
  std::frexp(std::max(side, 1e-300), &sideBits);
  std::frexp(std::max(2 * (far + side), 1e-300), &farBits);
  const int unitBits = std::max(sideBits - 47, farBits - 52);
  unit_ = std::ldexp(1.0, unitBits);
  coarse_ = std::ldexp(1.0, std::max(0, sideBits - 37 - unitBits));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double centre = box.low[axis] / 2 + box.high[axis] / 2;
    origin_[axis] = std::nearbyint(centre / unit_) * unit_;
  }
}

Vec3d WorkingLattice::toLattice(const Vec3d& world) const {
  // The origin is whole in units, so that the rounding of the quotient is the only one.
  const Vec3d whole = roundToLattice({world[0] / unit_, world[1] / unit_, world[2] / unit_});
  return {whole[0] - origin_[0] / unit_, whole[1] - origin_[1] / unit_,
          whole[2] - origin_[2] / unit_};
}

Vec3d WorkingLattice::toWorld(const Vec3d& lattice) const {
  return {origin_[0] + lattice[0] * unit_, origin_[1] + lattice[1] * unit_,
          origin_[2] + lattice[2] * unit_};
}

double exactDeterminant(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  // Differences have 48 bits and a sign, minors of two 98.
  const auto difference = [&](const Vec3d& p, std::size_t axis) {
    return static_cast<Int128>(static_cast<std::int64_t>(p[axis] - a[axis]));
  };
  const Int128 ux = difference(b, 0), uy = difference(b, 1), uz = difference(b, 2);
  const Int128 vx = difference(c, 0), vy = difference(c, 1), vz = difference(c, 2);
  const auto product = [&](std::size_t axis, Int128 minor) {
    return WideInteger<3>(difference(d, axis)) * WideInteger<3>(minor);
  };
  const WideInteger<3> sum =
      product(0, uy * vz - uz * vy) + product(1, uz * vx - ux * vz) + product(2, ux * vy - uy * vx);
  const WideInteger<3> size = sum.sign() < 0 ? -sum : sum;
  const double rounded =
      static_cast<double>(size.wordsFrom(1)) * 0x1p64 + static_cast<double>(size.word(0));
  return sum.sign() < 0 ? -rounded : rounded;
}

} // namespace tetvdb
