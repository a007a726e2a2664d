// SPDX-License-Identifier: Apache-2.0
//
// Source of the method: J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast
// Robust Geometric Predicates (1997), sections 2.2 to 2.5, which follow Dekker, Knuth and Priest.
#include "tetvdb/geometry/Orientation.h"

#include "tetvdb/geometry/Exact.h"
#include "tetvdb/geometry/RoundedDeterminant.h"
#include "tetvdb/geometry/WideInteger.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tetvdb {
namespace {

// The error bound in the plane is less than 4 units of 2^-53, relative to the sum of the absolute
// products; twice that for its own rounding.
constexpr double kError2 = 8 * 0x1p-53;
// Below this sum, products may have lost bits by underflow.
constexpr double kMinSum = 0x1p-900;

struct Pair {
  double high, low; // high is the rounded result, low the error
};

Pair sumOf(double a, double b) { // Knuth
  const double high = a + b;
  const double bPart = high - a;
  const double aPart = high - bPart;
  return {high, (a - aPart) + (b - bPart)};
}

// Two halves of 26 bits (Veltkamp).
Pair halves(double a) {
  constexpr double kSplit = 0x1p27 + 1;
  const double c = kSplit * a;
  const double high = c - (c - a);
  return {high, a - high};
}

Pair productOf(double a, double b) { // Dekker
  const double high = a * b;
  const Pair x = halves(a), y = halves(b);
  const double error = ((high - x.high * y.high) - x.low * y.high) - x.high * y.low;
  return {high, x.low * y.low - error};
}

// The exact sum of terms that do not overlap, ascending in absolute value, none of them 0. A 3 x 3
// determinant of differences has at most 192.
struct Expansion {
  std::array<double, 192> term;
  std::size_t size = 0;

  Expansion() {} // the terms are not initialised
  void push(double t) {
    if (t != 0)
      term[size++] = t;
  }
  int sign() const { return size == 0 ? 0 : signOf(term[size - 1]); }
};

Expansion difference(double a, double b) {
  const Pair d = sumOf(a, -b);
  Expansion e;
  e.push(d.low);
  e.push(d.high);
  return e;
}

void add(Expansion& e, double b) {
  const std::size_t size = e.size;
  e.size = 0; // terms are written behind the one that is read
  for (std::size_t i = 0; i < size; ++i) {
    const Pair s = sumOf(b, e.term[i]);
    e.push(s.low);
    b = s.high;
  }
  e.push(b);
}

void add(Expansion& e, const Expansion& f, double sign) {
  for (std::size_t i = 0; i < f.size; ++i)
    add(e, sign * f.term[i]);
}

void addScaled(Expansion& sum, const Expansion& e, double b) {
  for (std::size_t i = 0; i < e.size; ++i) {
    const Pair p = productOf(e.term[i], b);
    add(sum, p.low);
    add(sum, p.high);
  }
}

Expansion product(const Expansion& e, const Expansion& f) {
  Expansion result;
  for (std::size_t i = 0; i < f.size; ++i)
    addScaled(result, e, f.term[i]);
  return result;
}

// x0 y1 - x1 y0
Expansion minor2(const Expansion& x0, const Expansion& x1, const Expansion& y0,
                 const Expansion& y1) {
  Expansion result = product(x0, y1);
  add(result, product(x1, y0), -1);
  return result;
}

// Sets `sign` and returns true if the differences are multiples of 2^-61 of the largest one's power
// of two. Points exactly on one plane or line often are, and expansions take some 15 times as long.
bool orientationInIntegers(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d,
                           int& sign) {
  const std::array<const Vec3d*, 3> ends{&b, &c, &d};
  std::array<std::array<Pair, 3>, 3> m;
  double max = 0;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      m[row][axis] = sumOf((*ends[row])[axis], -a[axis]);
      max = std::max(max, std::abs(m[row][axis].high));
    }
  if (!(max > 0x1p-900 && max < 0x1p900))
    return false;
  const double scale = std::scalbn(1.0, 60 - std::ilogb(max));
  std::array<std::array<std::int64_t, 3>, 3> n;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double high = scale * m[row][axis].high, low = scale * m[row][axis].low;
      const auto wholeHigh = static_cast<std::int64_t>(high);
      const auto wholeLow = static_cast<std::int64_t>(low);
      if (static_cast<double>(wholeHigh) != high || static_cast<double>(wholeLow) != low)
        return false;
      n[row][axis] = wholeHigh + wholeLow; // below 2^62
    }
  using Wide = WideInteger<3>;
  Wide sum(0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t p = (axis + 1) % 3, q = (axis + 2) % 3;
    const Int128 minor = Int128(n[0][p]) * n[1][q] - Int128(n[0][q]) * n[1][p];
    sum = sum + Wide(minor) * Wide(n[2][axis]);
  }
  sign = sum.sign();
  return true;
}

int exactOrientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  if (int sign = 0; orientationInIntegers(a, b, c, d, sign))
    return sign;
  std::array<std::array<Expansion, 3>, 3> m;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    m[0][axis] = difference(b[axis], a[axis]);
    m[1][axis] = difference(c[axis], a[axis]);
    m[2][axis] = difference(d[axis], a[axis]);
  }
  Expansion sum;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t p = (axis + 1) % 3, q = (axis + 2) % 3;
    if (m[2][axis].size > 0)
      add(sum, product(minor2(m[0][p], m[0][q], m[1][p], m[1][q]), m[2][axis]), 1);
  }
  return sum.sign();
}

} // namespace

int orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  for (std::size_t axis = 0; axis < 3; ++axis) // frequent, and fast to test
    if (a[axis] == b[axis] && b[axis] == c[axis] && c[axis] == d[axis])
      return 0;
  const RoundedDeterminant rounded(b[0] - a[0], b[1] - a[1], b[2] - a[2], c[0] - a[0], c[1] - a[1],
                                   c[2] - a[2], d[0] - a[0], d[1] - a[1], d[2] - a[2]);
  const int sign = rounded.sign(RoundedDeterminant::kOfRounded);
  return sign != 0 && rounded.size > kMinSum ? sign : exactOrientation(a, b, c, d);
}

int orientation(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  const double left = (b[0] - a[0]) * (c[1] - a[1]);
  const double right = (b[1] - a[1]) * (c[0] - a[0]);
  const double determinant = left - right, sum = std::abs(left) + std::abs(right);
  if (sum > kMinSum && std::abs(determinant) > kError2 * sum)
    return signOf(determinant);
  return minor2(difference(b[0], a[0]), difference(b[1], a[1]), difference(c[0], a[0]),
                difference(c[1], a[1]))
      .sign();
}

bool areCollinear(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t p = (axis + 1) % 3, q = (axis + 2) % 3;
    if (orientation(Vec2d{a[p], a[q]}, Vec2d{b[p], b[q]}, Vec2d{c[p], c[q]}) != 0)
      return false;
  }
  return true;
}

} // namespace tetvdb
