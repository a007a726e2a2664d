// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/PlacePoint.h"

#include "tetvdb/geometry/VectorMath.h"

#include <cmath>

namespace tetvdb {
namespace {

// (p, a, b, c): P and det with their gradients in p.
struct Slopes {
  double squares, det;
  Vec3d ofSquares, ofDet;

  Slopes(const Vec3d& at, const PointStar::LinkFace& face) {
    const Vec3d u = minus(face.a, at), v = minus(face.b, at), w = minus(face.c, at);
    const Vec3d sum = plus(plus(u, v), w);
    squares = 4 * (dot(u, u) + dot(v, v) + dot(w, w)) - dot(sum, sum);
    det = dot(w, cross(u, v));
    ofSquares = times(sum, -2);
    ofDet = times(cross(minus(face.b, face.a), minus(face.c, face.a)), -1);
  }
};

} // namespace

double sumOfCubes(const std::vector<PointStar::LinkFace>& faces, const Vec3d& at, double limit) {
  double sum = 0;
  for (const PointStar::LinkFace& face : faces) {
    const double cube = face.weight * energyCube(at, face.a, face.b, face.c);
    if (!(cube <= limit))
      return std::numeric_limits<double>::infinity();
    sum += cube;
  }
  return sum;
}

bool newtonStep(const std::vector<PointStar::LinkFace>& faces, const Vec3d& at, Vec3d& step) {
  Vec3d gradient{0, 0, 0};
  double h00 = 0, h01 = 0, h02 = 0, h11 = 0, h12 = 0, h22 = 0;
  for (const PointStar::LinkFace& face : faces) {
    const Slopes slopes(at, face);
    if (!(slopes.det > 0))
      return false;
    const double f =
        face.weight * slopes.squares * slopes.squares * slopes.squares / (slopes.det * slopes.det);
    const Vec3d p = times(slopes.ofSquares, 1 / slopes.squares);
    const Vec3d d = times(slopes.ofDet, 1 / slopes.det);
    const Vec3d q = minus(p, d);
    gradient = plus(gradient, times(minus(times(p, 3), times(d, 2)), f));
    const double even = 18 * f / slopes.squares;
    h00 += 6 * f * q[0] * q[0] + even;
    h01 += 6 * f * q[0] * q[1];
    h02 += 6 * f * q[0] * q[2];
    h11 += 6 * f * q[1] * q[1] + even;
    h12 += 6 * f * q[1] * q[2];
    h22 += 6 * f * q[2] * q[2] + even;
  }
  const double c00 = h11 * h22 - h12 * h12, c01 = h02 * h12 - h01 * h22,
               c02 = h01 * h12 - h02 * h11, c11 = h00 * h22 - h02 * h02,
               c12 = h01 * h02 - h00 * h12, c22 = h00 * h11 - h01 * h01;
  const double det = h00 * c00 + h01 * c01 + h02 * c02;
  if (!(det > 0))
    return false;
  step = times({c00 * gradient[0] + c01 * gradient[1] + c02 * gradient[2],
                c01 * gradient[0] + c11 * gradient[1] + c12 * gradient[2],
                c02 * gradient[0] + c12 * gradient[1] + c22 * gradient[2]},
               -1 / det);
  return std::isfinite(step[0] + step[1] + step[2]) && std::abs(step[0]) < kLatticeBound &&
         std::abs(step[1]) < kLatticeBound && std::abs(step[2]) < kLatticeBound;
}

} // namespace tetvdb
