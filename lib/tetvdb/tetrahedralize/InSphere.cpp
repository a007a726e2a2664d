// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/InSphere.h"

#include "tetvdb/geometry/Exact.h"

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

// A sum of products of 117 by 78 bits, in digits of 59.
class WideSum {
public:
  void add(Int128 minor, Int128 square) {
    const Int128 high = minor >> kDigit, low = minor & kMask;
    const Int128 top = square >> kDigit, bottom = square & kMask;
    digits_[2] += high * top;
    digits_[1] += high * bottom + low * top;
    digits_[0] += low * bottom;
  }
  bool positive() {
    digits_[1] += digits_[0] >> kDigit;
    digits_[2] += digits_[1] >> kDigit;
    if (digits_[2] != 0)
      return digits_[2] > 0;
    return (digits_[1] & kMask) != 0 || (digits_[0] & kMask) != 0;
  }

private:
  static constexpr int kDigit = 59;
  static constexpr Int128 kMask = (Int128(1) << kDigit) - 1;
  Int128 digits_[3] = {0, 0, 0};
};

} // namespace

bool liesInSphereExactly(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d,
                         const Vec3d& p) {
  const Row ra = rowOf(a, p), rb = rowOf(b, p), rc = rowOf(c, p), rd = rowOf(d, p);
  const Int128 ab = minorOf(ra, rb), ac = minorOf(ra, rc), ad = minorOf(ra, rd);
  const Int128 bc = minorOf(rb, rc), bd = minorOf(rb, rd), cd = minorOf(rc, rd);
  WideSum sum;
  sum.add(rb.z * cd - rc.z * bd + rd.z * bc, ra.square);
  sum.add(-(ra.z * cd - rc.z * ad + rd.z * ac), rb.square);
  sum.add(ra.z * bd - rb.z * ad + rd.z * ab, rc.square);
  sum.add(-(ra.z * bc - rb.z * ac + rc.z * ab), rd.square);
  return sum.positive();
}

} // namespace tetvdb
