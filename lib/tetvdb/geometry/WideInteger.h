// SPDX-License-Identifier: Apache-2.0
//
// Integers of a fixed number of 64-bit words, for predicates whose values do not fit Int128.
#pragma once

#include "tetvdb/geometry/Exact.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// Two's complement. Overflow wraps around: callers know the bounds.
template <std::size_t Words>
class WideInteger {
  __extension__ typedef unsigned __int128 UInt128;

public:
  WideInteger() = default;
  WideInteger(Int128 value) {
    const std::uint64_t fill = value < 0 ? ~std::uint64_t(0) : 0;
    words_.fill(fill);
    words_[0] = static_cast<std::uint64_t>(value);
    words_[1] = static_cast<std::uint64_t>(value >> 64);
  }

  friend WideInteger operator+(const WideInteger& a, const WideInteger& b) {
    WideInteger sum;
    UInt128 carry = 0;
    for (std::size_t i = 0; i < Words; ++i) {
      carry += UInt128(a.words_[i]) + b.words_[i];
      sum.words_[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    return sum;
  }
  friend WideInteger operator-(const WideInteger& a) {
    WideInteger inverted;
    for (std::size_t i = 0; i < Words; ++i)
      inverted.words_[i] = ~a.words_[i];
    return inverted + WideInteger(1);
  }
  friend WideInteger operator-(const WideInteger& a, const WideInteger& b) { return a + -b; }
  friend WideInteger operator*(const WideInteger& a, const WideInteger& b) {
    WideInteger product(0);
    for (std::size_t i = 0; i < Words; ++i) {
      UInt128 carry = 0;
      for (std::size_t k = 0; i + k < Words; ++k) {
        carry += UInt128(a.words_[i]) * b.words_[k] + product.words_[i + k];
        product.words_[i + k] = static_cast<std::uint64_t>(carry);
        carry >>= 64;
      }
    }
    return product;
  }

  int sign() const {
    if (words_.back() >> 63 != 0)
      return -1;
    for (const std::uint64_t word : words_)
      if (word != 0)
        return 1;
    return 0;
  }

  /// Bits 64 i to 64 i + 63.
  std::uint64_t word(std::size_t i) const { return words_[i]; }
  /// Bits 64 i to 64 i + 127.
  Int128 wordsFrom(std::size_t i) const {
    return static_cast<Int128>(UInt128(words_[i + 1]) << 64 | words_[i]);
  }
  /// With a relative error of 2^-52.
  double toDouble() const {
    if (sign() < 0)
      return -(-*this).toDouble();
    double value = 0;
    std::size_t first = Words;
    while (first > 0 && words_[first - 1] == 0)
      --first;
    for (std::size_t i = first; i > 0 && i + 3 > first; --i)
      value += std::ldexp(static_cast<double>(words_[i - 1]), static_cast<int>(64 * (i - 1)));
    return value;
  }

private:
  std::array<std::uint64_t, Words> words_{}; // lowest first
};

} // namespace tetvdb
