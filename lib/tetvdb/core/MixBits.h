// SPDX-License-Identifier: Apache-2.0
//
// Numbers that look random and depend on nothing but their argument (Steele, Lea and Flood, Fast
// Splittable Pseudorandom Number Generators, 2014: SplitMix64).
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstdint>
#include <cstring>

namespace tetvdb {

/// 2^64 over the golden ratio, an odd number.
constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15u;

/// SplitMix64's finalizer: a bijection; 0 stays 0.
inline std::uint64_t mixBits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

/// The number after `index` others of the sequence that starts with 0.
inline std::uint64_t hashOfIndex(std::uint64_t index) {
  return mixBits((index + 1) * kGoldenRatio);
}

/// The same for equal points: -0 counts as 0.
inline std::uint64_t hashOfPoint(const Vec3d& p) {
  std::uint64_t hash = 0;
  for (const double coordinate : p) {
    const double number = coordinate + 0.0; // -0 becomes 0
    std::uint64_t bits;
    std::memcpy(&bits, &number, sizeof bits);
    hash = mixBits(hash ^ bits) + kGoldenRatio;
  }
  return hash;
}

} // namespace tetvdb
