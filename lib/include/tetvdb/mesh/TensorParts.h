// SPDX-License-Identifier: Apache-2.0
//
// Invariants of 3 x 3 tensors, rows first. Additions, multiplications, divisions and square roots
// alone, in a fixed order: the same bits on every machine and GPU.
#pragma once

#include "tetvdb/core/HostDevice.h"

#include <array>
#include <cmath>
#include <limits>

namespace tetvdb {

using Tensor = std::array<double, 9>;

TETVDB_HD inline double traceOf(const Tensor& t) {
  return t[0] + t[4] + t[8];
}

TETVDB_HD inline double determinantOf(const Tensor& t) {
  return t[0] * (t[4] * t[8] - t[5] * t[7]) - t[1] * (t[3] * t[8] - t[5] * t[6]) +
         t[2] * (t[3] * t[7] - t[4] * t[6]);
}

/// The entries of a symmetric tensor.
struct SymmetricTensor {
  double xx, yy, zz, xy, yz, xz;
};

TETVDB_HD inline SymmetricTensor symmetricPart(const Tensor& t) {
  return {t[0], t[4], t[8], (t[1] + t[3]) / 2, (t[5] + t[7]) / 2, (t[2] + t[6]) / 2};
}

/// Von Mises' equivalent of the symmetric part: sqrt(3/2 s:s), s the deviator.
TETVDB_HD inline double misesOf(const Tensor& t) {
  const SymmetricTensor s = symmetricPart(t);
  const double a = s.xx - s.yy, b = s.yy - s.zz, c = s.zz - s.xx;
  return std::sqrt((a * a + b * b + c * c) / 2 + 3 * (s.xy * s.xy + s.yz * s.yz + s.xz * s.xz));
}

namespace tensor_internal {

/// One rotation that makes a[p][q] zero (Golub and Van Loan, Matrix Computations, 8.5.2).
TETVDB_HD inline void rotate(double (&a)[3][3], int p, int q) {
  if (a[p][q] == 0)
    return;
  const double tau = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const double root = std::sqrt(1 + tau * tau);
  const double t = tau >= 0 ? 1 / (tau + root) : 1 / (tau - root);
  const double c = 1 / std::sqrt(1 + t * t), s = t * c;
  const int r = 3 - p - q;
  const double rp = a[r][p], rq = a[r][q];
  a[p][p] -= t * a[p][q];
  a[q][q] += t * a[p][q];
  a[p][q] = a[q][p] = 0;
  a[r][p] = a[p][r] = c * rp - s * rq;
  a[r][q] = a[q][r] = s * rp + c * rq;
}

TETVDB_HD inline void orderDown(double& a, double& b) {
  if (a < b) {
    const double larger = b;
    b = a;
    a = larger;
  }
}

} // namespace tensor_internal

/// Eigenvalues of the symmetric part, the largest first, by Jacobi's rotations; good to a few units
/// in the last place of the largest absolute value. NaN where an entry is not finite.
TETVDB_HD inline std::array<double, 3> principalsOf(const Tensor& t) {
  const SymmetricTensor s = symmetricPart(t);
  const double sum = s.xx + s.yy + s.zz + s.xy + s.yz + s.xz;
  if (!(sum - sum == 0)) { // it is not finite
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan};
  }
  double a[3][3] = {{s.xx, s.xy, s.xz}, {s.xy, s.yy, s.yz}, {s.xz, s.yz, s.zz}};
  // Converges quadratically: four sweeps suffice for 3 x 3, the rest is margin.
  for (int sweep = 0; sweep < 8; ++sweep) {
    tensor_internal::rotate(a, 0, 1);
    tensor_internal::rotate(a, 0, 2);
    tensor_internal::rotate(a, 1, 2);
  }
  double low = a[2][2], mid = a[1][1], high = a[0][0];
  tensor_internal::orderDown(high, mid);
  tensor_internal::orderDown(mid, low);
  tensor_internal::orderDown(high, mid);
  return {high, mid, low};
}

} // namespace tetvdb
