// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/SmoothPoints.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/TetEnergy.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetvdb {
namespace {

constexpr int kSteps = 4, kHalvings = 6;
// A step that gains less is the last.
constexpr double kGain = 0.98;
// Points of more tets take long and do not matter more than others.
constexpr std::size_t kManyTets = 300;

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

std::size_t PointSmoother::sweep() {
  std::size_t moves = 0;
  for (std::uint32_t p = 0; p < complex_.points.size(); ++p) {
    const TetComplex::Point& point = complex_.points[p];
    if (point.exists() && !point.fixed && (point.changed & kChanged))
      moves += smooth(p);
  }
  return moves;
}

bool PointSmoother::smooth(std::uint32_t point) {
  const auto settle = [&] {
    std::uint8_t& changed = complex_.points[point].changed;
    changed = static_cast<std::uint8_t>(changed & ~kChanged);
    return false;
  };
  star_.gather(complex_, point);
  if (star_.worstEnergy() <= energy_ || star_.tets().size() > kManyTets)
    return settle();
  onRim_ = complex_.points[point].rim;
  if (onRim_) {
    std::size_t ends = 0;
    for (const PointStar::Spoke& spoke : star_.spokes())
      if (spoke.sheets == 1) {
        if (ends == 2)
          return settle();
        rim_[ends++] = spoke.point;
      }
    if (ends != 2 || bounds_.rim.empty())
      return settle();
  }
  ++tried_;
  const Vec3d old = complex_.at(point);
  const double before = cubes(old);
  Vec3d at = old;
  double now = before;
  for (int i = 0; i < kSteps; ++i) {
    Vec3d move;
    if (!step(at, move))
      break;
    double next = now;
    Vec3d trial = at;
    for (int halving = 0; halving < kHalvings; ++halving) {
      trial = roundToLattice(plus(at, move));
      project(trial);
      next = cubes(trial);
      if (next < now)
        break;
      move = times(move, 0.5);
    }
    if (!(next < now))
      break;
    const double gain = next / now;
    at = trial;
    now = next;
    if (gain > kGain)
      break;
  }
  if (!(now < kGain * before) || !keepsBounds(at))
    return settle();
  complex_.move(point, at, star_.tets());
  return true;
}

// Newton's. False where rounding leaves nothing to go by.
bool PointSmoother::step(const Vec3d& at, Vec3d& move) const {
  Vec3d gradient{0, 0, 0};
  double h00 = 0, h01 = 0, h02 = 0, h11 = 0, h12 = 0, h22 = 0;
  for (const PointStar::LinkFace& face : star_.faces()) {
    const Slopes slopes(at, face);
    if (!(slopes.det > 0))
      return false;
    const double f = slopes.squares * slopes.squares * slopes.squares / (slopes.det * slopes.det);
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
  move = times({c00 * gradient[0] + c01 * gradient[1] + c02 * gradient[2],
                c01 * gradient[0] + c11 * gradient[1] + c12 * gradient[2],
                c02 * gradient[0] + c12 * gradient[1] + c22 * gradient[2]},
               -1 / det);
  return std::isfinite(move[0] + move[1] + move[2]) && std::abs(move[0]) < kLatticeBound &&
         std::abs(move[1]) < kLatticeBound && std::abs(move[2]) < kLatticeBound;
}

// The sum, in sixteenths; infinity where a tet is not positive or worse than the worst before.
double PointSmoother::cubes(const Vec3d& at) const {
  const double worst = star_.worstEnergy();
  const double limit = worst * worst * worst * (1 + 1e-6);
  double sum = 0;
  for (const PointStar::LinkFace& face : star_.faces()) {
    const double cube = energyCube(at, face.a, face.b, face.c);
    if (cube > limit)
      return std::numeric_limits<double>::infinity();
    sum += cube;
  }
  return sum;
}

// Onto the rim or the surface, where the point is on one.
void PointSmoother::project(Vec3d& at) const {
  if (onRim_)
    at = roundToLattice(bounds_.rim.nearest(at).point);
  else if (star_.onSurface())
    at = roundToLattice(bounds_.surface.nearest(at).point);
}

bool PointSmoother::keepsBounds(const Vec3d& at) {
  if (onRim_)
    for (const std::uint32_t end : rim_)
      if (!bounds_.rim.contains(at, complex_.at(end), bounds_.radius))
        return false;
  return !star_.onSurface() || guard_.allows(complex_, star_, at);
}

} // namespace tetvdb
