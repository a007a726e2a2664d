// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/TensorParts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace tetvdb {
namespace {

// xx, yy, zz, xy, yz, xz.
std::array<double, 6> symmetricPart(const Tensor& t) {
  return {t[0], t[4], t[8], (t[1] + t[3]) / 2, (t[5] + t[7]) / 2, (t[2] + t[6]) / 2};
}

// One rotation that makes a[p][q] zero (Golub and Van Loan, Matrix Computations, 8.5.2).
void rotate(double (&a)[3][3], int p, int q) {
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

} // namespace

double traceOf(const Tensor& t) {
  return t[0] + t[4] + t[8];
}

double determinantOf(const Tensor& t) {
  return t[0] * (t[4] * t[8] - t[5] * t[7]) - t[1] * (t[3] * t[8] - t[5] * t[6]) +
         t[2] * (t[3] * t[7] - t[4] * t[6]);
}

double misesOf(const Tensor& t) {
  const auto [xx, yy, zz, xy, yz, xz] = symmetricPart(t);
  const double a = xx - yy, b = yy - zz, c = zz - xx;
  return std::sqrt((a * a + b * b + c * c) / 2 + 3 * (xy * xy + yz * yz + xz * xz));
}

std::array<double, 3> principalsOf(const Tensor& t) {
  const auto [xx, yy, zz, xy, yz, xz] = symmetricPart(t);
  if (!std::isfinite(xx + yy + zz + xy + yz + xz)) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan};
  }
  double a[3][3] = {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}};
  // Converges quadratically: four sweeps suffice for 3 x 3, the rest is margin.
  for (int sweep = 0; sweep < 8; ++sweep) {
    rotate(a, 0, 1);
    rotate(a, 0, 2);
    rotate(a, 1, 2);
  }
  std::array<double, 3> values{a[0][0], a[1][1], a[2][2]};
  std::sort(values.begin(), values.end(), std::greater<double>());
  return values;
}

} // namespace tetvdb
