// SPDX-License-Identifier: Apache-2.0
//
// The sign of a tet's volume for any doubles, by whole numbers of any length. Shares no code with
// the library.
#pragma once

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace exact_volume {

using Point = std::array<double, 3>;

/// A whole number: its sign, and digits of 32 bits, the lowest first.
class Whole {
public:
  /// value * 2^-unit, which is whole.
  Whole(double value, int unit) : negative_(value < 0) {
    int exponent = 0;
    const double fraction = std::frexp(std::abs(value), &exponent);
    auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    int shift = exponent - 53 - unit;
    for (; mantissa != 0 && shift < 0; ++shift)
      mantissa >>= 1; // zeros, or the number is not whole
    digits_.assign(static_cast<std::size_t>(std::max(shift, 0) / 32), 0);
    const int rest = std::max(shift, 0) % 32;
    for (int k = 0; k < 3; ++k) {
      const int from = 32 * k - rest; // of the mantissa, bits from here
      const std::uint64_t bits =
          from < 0 ? mantissa << -from : (from < 64 ? mantissa >> from : std::uint64_t(0));
      digits_.push_back(static_cast<std::uint32_t>(bits));
    }
    trim();
  }

  int sign() const { return digits_.empty() ? 0 : (negative_ ? -1 : 1); }

  friend Whole operator*(const Whole& a, const Whole& b) {
    Whole product;
    product.negative_ = a.negative_ != b.negative_;
    product.digits_.assign(a.digits_.size() + b.digits_.size(), 0);
    for (std::size_t i = 0; i < a.digits_.size(); ++i) {
      std::uint64_t carry = 0;
      for (std::size_t k = 0; k < b.digits_.size(); ++k) {
        carry += std::uint64_t(a.digits_[i]) * b.digits_[k] + product.digits_[i + k];
        product.digits_[i + k] = static_cast<std::uint32_t>(carry);
        carry >>= 32;
      }
      product.digits_[i + b.digits_.size()] = static_cast<std::uint32_t>(carry);
    }
    product.trim();
    return product;
  }
  friend Whole operator-(const Whole& a, const Whole& b) {
    if (a.negative_ != b.negative_)
      return sum(a, b);
    return a.smallerThan(b) ? difference(b, a, !b.negative_) : difference(a, b, a.negative_);
  }
  friend Whole operator+(const Whole& a, Whole b) {
    b.negative_ = !b.negative_;
    return a - b;
  }

private:
  Whole() = default;
  void trim() {
    while (!digits_.empty() && digits_.back() == 0)
      digits_.pop_back();
  }
  bool smallerThan(const Whole& other) const { // of absolute values
    if (digits_.size() != other.digits_.size())
      return digits_.size() < other.digits_.size();
    return std::lexicographical_compare(digits_.rbegin(), digits_.rend(), other.digits_.rbegin(),
                                        other.digits_.rend());
  }
  // The sum of the absolute values, with a's sign.
  static Whole sum(const Whole& a, const Whole& b) {
    Whole made;
    made.negative_ = a.negative_;
    std::uint64_t carry = 0;
    for (std::size_t i = 0; i < std::max(a.digits_.size(), b.digits_.size()) + 1; ++i) {
      carry += i < a.digits_.size() ? a.digits_[i] : 0u;
      carry += i < b.digits_.size() ? b.digits_[i] : 0u;
      made.digits_.push_back(static_cast<std::uint32_t>(carry));
      carry >>= 32;
    }
    made.trim();
    return made;
  }
  // The difference of the absolute values; the first is not smaller.
  static Whole difference(const Whole& large, const Whole& small, bool negative) {
    Whole made;
    made.negative_ = negative;
    std::int64_t carry = 0;
    for (std::size_t i = 0; i < large.digits_.size(); ++i) {
      carry += large.digits_[i];
      carry -= i < small.digits_.size() ? small.digits_[i] : 0u;
      made.digits_.push_back(static_cast<std::uint32_t>(carry & 0xFFFFFFFF));
      carry >>= 32;
    }
    made.trim();
    return made;
  }

  bool negative_ = false;
  std::vector<std::uint32_t> digits_;
};

/// The exponent of a double's lowest bit that is set.
inline int lowestBit(double value) {
  int exponent = 0;
  auto mantissa =
      static_cast<std::uint64_t>(std::ldexp(std::frexp(std::abs(value), &exponent), 53));
  exponent -= 53;
  for (; mantissa != 0 && (mantissa & 1) == 0; mantissa >>= 1)
    ++exponent;
  return mantissa == 0 ? INT_MAX : exponent;
}

/// The sign of (b - a) x (c - a) . (d - a).
inline int signByWholes(const Point& a, const Point& b, const Point& c, const Point& d) {
  int unit = INT_MAX;
  for (const Point* p : {&a, &b, &c, &d})
    for (const double x : *p)
      unit = std::min(unit, lowestBit(x));
  if (unit == INT_MAX)
    return 0;
  const auto from = [&](const Point& p, std::size_t axis) {
    return Whole(p[axis], unit) - Whole(a[axis], unit);
  };
  const Whole ux = from(b, 0), uy = from(b, 1), uz = from(b, 2);
  const Whole vx = from(c, 0), vy = from(c, 1), vz = from(c, 2);
  const Whole wx = from(d, 0), wy = from(d, 1), wz = from(d, 2);
  return (wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx)).sign();
}

/// Six times the signed volume, rounded.
inline long double sixfold(const Point& a, const Point& b, const Point& c, const Point& d,
                           long double& absSum) {
  using Real = long double;
  const Real ux = Real(b[0]) - a[0], uy = Real(b[1]) - a[1], uz = Real(b[2]) - a[2];
  const Real vx = Real(c[0]) - a[0], vy = Real(c[1]) - a[1], vz = Real(c[2]) - a[2];
  const Real wx = Real(d[0]) - a[0], wy = Real(d[1]) - a[1], wz = Real(d[2]) - a[2];
  absSum = std::abs(wx) * (std::abs(uy * vz) + std::abs(uz * vy)) +
           std::abs(wy) * (std::abs(uz * vx) + std::abs(ux * vz)) +
           std::abs(wz) * (std::abs(ux * vy) + std::abs(uy * vx));
  return wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx);
}

/// The same, quick where rounding (a dozen units of 2^-53 at most, whatever a long double is)
/// cannot change it.
inline int sign(const Point& a, const Point& b, const Point& c, const Point& d) {
  long double absSum = 0;
  const long double volume = sixfold(a, b, c, d, absSum);
  if (std::abs(volume) > 0x1p-49L * absSum)
    return volume > 0 ? 1 : -1;
  return signByWholes(a, b, c, d);
}

} // namespace exact_volume
