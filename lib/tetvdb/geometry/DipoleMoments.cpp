// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/DipoleMoments.h"

#include "tetvdb/geometry/VectorMath.h"

#include <cstddef>

namespace tetvdb {

// With s = a + b + c, the mean of y over a triangle is s / 3, that of y y^T (a a^T + b b^T + c c^T
// + s s^T) / 12.
void DipoleMoments::add(const Vec3d& a, const Vec3d& b, const Vec3d& c, double weight) {
  const Vec3d sum = plus(plus(a, b), c);
  const Vec3d n = times(cross(minus(b, a), minus(c, a)), weight / 2);
  double second[3][3], third[3][3][3];
  for (std::size_t k = 0; k < 3; ++k) {
    dipole_[k] += n[k];
    for (std::size_t l = 0; l < 3; ++l) {
      second[k][l] = n[k] * sum[l] / 3;
      for (std::size_t m = 0; m < 3; ++m)
        third[k][l][m] = n[k] * (a[l] * a[m] + b[l] * b[m] + c[l] * c[m] + sum[l] * sum[m]) / 12;
    }
  }
  trace_ += second[0][0] + second[1][1] + second[2][2];
  for (std::size_t k = 0; k < 3; ++k)
    quadrupole_[k] += second[k][k];
  quadrupole_[3] += second[0][1] + second[1][0];
  quadrupole_[4] += second[0][2] + second[2][0];
  quadrupole_[5] += second[1][2] + second[2][1];
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t l = 0; l < 3; ++l)
      bent_[k] += 2 * third[l][l][k] + third[k][l][l];
  const auto mixed = [&](std::size_t k, std::size_t l) { // the factor of y_k^2 y_l
    return third[l][k][k] + 2 * third[k][k][l];
  };
  const double octupole[10] = {
      third[0][0][0], third[1][1][1],
      third[2][2][2], mixed(0, 1),
      mixed(0, 2),    mixed(1, 0),
      mixed(1, 2),    mixed(2, 0),
      mixed(2, 1),    2 * (third[0][1][2] + third[1][0][2] + third[2][0][1])};
  for (std::size_t k = 0; k < 10; ++k)
    octupole_[k] += octupole[k];
}

} // namespace tetvdb
