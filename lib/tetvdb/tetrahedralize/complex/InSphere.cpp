// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/InSphere.h"

#include "tetvdb/geometry/WideInteger.h"

#include <cstdint>

namespace tetvdb {
namespace {

// Differences have 38 bits and a sign, so that squares and minors of two rows have 78 bits and
// minors of three rows 117.
struct Row {
  std::int64_t x, y, z;
  Int128 square;
};

Row rowOf(const Vec3d& q, const Vec3d& p) {
  const auto x = static_cast<std::int64_t>(q[0] - p[0]);
  const auto y = static_cast<std::int64_t>(q[1] - p[1]);
  const auto z = static_cast<std::int64_t>(q[2] - p[2]);
  return {x, y, z, Int128(x) * x + Int128(y) * y + Int128(z) * z};
}

Int128 minorOf(const Row& a, const Row& b) {
  return Int128(a.x) * b.y - Int128(a.y) * b.x;
}

} // namespace

bool liesInSphereExactly(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d,
                         const Vec3d& p) {
  const Row ra = rowOf(a, p), rb = rowOf(b, p), rc = rowOf(c, p), rd = rowOf(d, p);
  const Int128 ab = minorOf(ra, rb), ac = minorOf(ra, rc), ad = minorOf(ra, rd);
  const Int128 bc = minorOf(rb, rc), bd = minorOf(rb, rd), cd = minorOf(rc, rd);
  using Wide = WideInteger<4>; // products of 117 by 78 bits
  const Wide sum = Wide(rb.z * cd - rc.z * bd + rd.z * bc) * Wide(ra.square) -
                   Wide(ra.z * cd - rc.z * ad + rd.z * ac) * Wide(rb.square) +
                   Wide(ra.z * bd - rb.z * ad + rd.z * ab) * Wide(rc.square) -
                   Wide(ra.z * bc - rb.z * ac + rc.z * ab) * Wide(rd.square);
  return sum.sign() > 0;
}

} // namespace tetvdb
