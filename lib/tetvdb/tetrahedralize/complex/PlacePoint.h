// SPDX-License-Identifier: Apache-2.0
//
// The best place for a point within the faces around it.
//
// The sum of the cubes of energies, f = P^3 / (16 det^2) each, is minimized: the worst tets
// dominate it, and f is convex in the point as long as tets are positive. With p and d for the
// gradients of P and det, divided by P and det, the gradient is f (3 p - 2 d) and the matrix of
// second derivatives f (6 (p - d)(p - d)^T + 18 / P): positive definite, so that Newton's step
// descends.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/tetrahedralize/complex/PointStar.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"

#include <limits>
#include <vector>

namespace tetvdb {

/// The sum over tets (at, face); infinity where one is not positive or its cube is above `limit`.
double sumOfCubes(const std::vector<PointStar::LinkFace>& faces, const Vec3d& at, double limit);

/// Newton's step. False where it is lost in rounding.
bool newtonStep(const std::vector<PointStar::LinkFace>& faces, const Vec3d& at, Vec3d& step);

/// Moves `at` to a better lattice point in a few steps, each halved until it is one. `project`
/// moves a trial to where the point may lie. Returns the sum at the new place; `at` is unchanged
/// where no better point is found, or where the sum, `now`, is infinite.
template <typename Project>
double descend(const std::vector<PointStar::LinkFace>& faces, double limit, double now, Vec3d& at,
               const Project& project) {
  constexpr int kSteps = 4, kHalvings = 6;
  constexpr double kGain = 0.98; // a step that gains less is the last
  for (int i = 0; i < kSteps; ++i) {
    Vec3d step;
    if (!newtonStep(faces, at, step))
      return now;
    double next = now;
    Vec3d trial = at;
    for (int halving = 0; halving < kHalvings && !(next < now); ++halving) {
      trial = roundToLattice(plus(at, step));
      project(trial);
      next = sumOfCubes(faces, trial, limit);
      step = times(step, 0.5);
    }
    if (!(next < now))
      return now;
    const bool last = next > kGain * now;
    at = trial;
    now = next;
    if (last)
      return now;
  }
  return now;
}

} // namespace tetvdb
