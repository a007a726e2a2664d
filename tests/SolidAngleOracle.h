// SPDX-License-Identifier: Apache-2.0
//
// The solid angle of a triangle: an oracle for winding numbers.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>

namespace tetvdb::test {

/// A complex number whose angle is half the solid angle. In double for many points, else in long
/// double. `v`: the triangle's corners, seen from the point (Van Oosterom and Strackee, The Solid
/// Angle of a Plane Triangle, 1983).
template <class Real>
std::complex<Real> halfSolidAngle(const std::array<std::array<Real, 3>, 3>& v) {
  const auto dot = [&](std::size_t i, std::size_t j) {
    return v[i][0] * v[j][0] + v[i][1] * v[j][1] + v[i][2] * v[j][2];
  };
  const Real l[3] = {std::sqrt(dot(0, 0)), std::sqrt(dot(1, 1)), std::sqrt(dot(2, 2))};
  const Real triple = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) -
                      v[0][1] * (v[1][0] * v[2][2] - v[1][2] * v[2][0]) +
                      v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
  return {l[0] * l[1] * l[2] + dot(0, 1) * l[2] + dot(1, 2) * l[0] + dot(2, 0) * l[1], triple};
}

template <class Real>
Real solidAngle(const std::array<std::array<Real, 3>, 3>& v) {
  return 2 * std::arg(halfSolidAngle(v));
}

constexpr long double kSphere = 4 * 3.14159265358979323846L; ///< of all directions

} // namespace tetvdb::test
