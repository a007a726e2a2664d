// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/RimMoments.h"

#include "tetvdb/geometry/VectorMath.h"

namespace tetvdb {

// The cone's triangles have corners 0, a, b relative to the centre and area vectors n = a x b / 2.
// Mean of y over such a triangle is (a + b) / 3, of y y^T
// (a a^T + b b^T + (a + b)(a + b)^T) / 12.
ConeMoments::ConeMoments(const RimArrays& edges, std::size_t begin, std::size_t end,
                         const LatticePoint& centre) {
  double second[3][3] = {};
  double third[3][3][3] = {};
  for (std::size_t i = begin; i != end; ++i) {
    const Vec3d a = from(centre, edges.a(i)), b = from(centre, edges.b(i));
    const Vec3d sum = plus(a, b), n = times(cross(a, b), edges.weight[i] / 2);
    for (std::size_t k = 0; k < 3; ++k) {
      dipole_[k] += n[k];
      for (std::size_t l = 0; l < 3; ++l) {
        second[k][l] += n[k] * sum[l] / 3;
        for (std::size_t m = 0; m < 3; ++m)
          third[k][l][m] += n[k] * (a[l] * a[m] + b[l] * b[m] + sum[l] * sum[m]) / 12;
      }
    }
  }
  trace_ = second[0][0] + second[1][1] + second[2][2];
  quadrupole_ = {second[0][0],
                 second[1][1],
                 second[2][2],
                 second[0][1] + second[1][0],
                 second[0][2] + second[2][0],
                 second[1][2] + second[2][1]};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t l = 0; l < 3; ++l)
      bent_[k] += 2 * third[l][l][k] + third[k][l][l];
  const auto mixed = [&](std::size_t k, std::size_t l) { // the factor of y_k^2 y_l
    return third[l][k][k] + 2 * third[k][k][l];
  };
  octupole_ = {third[0][0][0], third[1][1][1],
               third[2][2][2], mixed(0, 1),
               mixed(0, 2),    mixed(1, 0),
               mixed(1, 2),    mixed(2, 0),
               mixed(2, 1),    2 * (third[0][1][2] + third[1][0][2] + third[2][0][1])};
}

void EndMoments::add(const Vec3d& y, double weight) {
  const double x0 = weight * y[0], y0 = weight * y[1];
  first_[0] += x0;
  first_[1] += y0;
  const double xx = x0 * y[0], xy = x0 * y[1], yy = y0 * y[1], zx = x0 * y[2], zy = y0 * y[2];
  second_[0] += xx;
  second_[1] += xy;
  second_[2] += yy;
  second_[3] += zx;
  second_[4] += zy;
  third_[0] += xx * y[0];
  third_[1] += xx * y[1];
  third_[2] += xy * y[1];
  third_[3] += yy * y[1];
  third_[4] += zx * y[0];
  third_[5] += zx * y[1];
  third_[6] += zy * y[1];
  third_[7] += zx * y[2];
  third_[8] += zy * y[2];
}

} // namespace tetvdb
