// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/core/Vec3.h"

#include <cmath>

namespace tetvdb {

TETVDB_HD inline Vec3d minus(const Vec3d& a, const Vec3d& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
TETVDB_HD inline Vec3d plus(const Vec3d& a, const Vec3d& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
TETVDB_HD inline Vec3d times(const Vec3d& a, double s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}
TETVDB_HD inline double dot(const Vec3d& a, const Vec3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
TETVDB_HD inline Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
TETVDB_HD inline double length(const Vec3d& a) {
  return std::sqrt(dot(a, a));
}
/// By x, then y, then z.
TETVDB_HD inline bool comesBefore(const Vec3d& a, const Vec3d& b) {
  return a[0] < b[0] || (a[0] == b[0] && (a[1] < b[1] || (a[1] == b[1] && a[2] < b[2])));
}

} // namespace tetvdb
