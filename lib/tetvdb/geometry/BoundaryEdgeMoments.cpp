// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/BoundaryEdgeMoments.h"

namespace tetvdb {

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
