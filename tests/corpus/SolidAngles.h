// SPDX-License-Identifier: Apache-2.0
//
// Generalised winding numbers by brute force. Shares no code with the library.
//
// The solid angle of a triangle is twice the argument of the complex number (den, num) of Van
// Oosterom and Strackee, "The solid angle of a plane triangle", IEEE Trans. Biomed. Eng. 30 (1983).
// Arguments are added by multiplying these numbers, and a whole turn is counted where the product
// crosses the negative real axis; one arctangent a point is left. Rounding: each factor's argument
// is right to about 1e-15 of a triangle's own angle, and each product adds 5e-16, so a sum over n
// triangles is right to about 1e-15 n turns in the worst case, 1e-9 for a million. Points on a
// triangle have no winding number: what they get is one of the two sides.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

// Sanitizers are not set up yet when the program chooses among the versions.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SOLID_ANGLES_CLONES                                                                        \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define SOLID_ANGLES_CLONES
#endif

namespace solid_angles {

constexpr std::size_t kLanes = 16; ///< points that go through the triangles together
using Lanes = std::array<double, kLanes>;
using Point = std::array<double, 3>;

/// Winding numbers of kLanes points with these coordinates. Lengths must be neither huge nor tiny:
/// products of three are taken.
SOLID_ANGLES_CLONES static void windings(const std::vector<std::array<Point, 3>>& triangles,
                                         const Lanes& x, const Lanes& y, const Lanes& z,
                                         Lanes& winding) {
  Lanes re, im, turns;
  re.fill(1);
  im.fill(0);
  turns.fill(0);
  for (const auto& t : triangles) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double ax = t[0][0] - x[i], ay = t[0][1] - y[i], az = t[0][2] - z[i];
      const double bx = t[1][0] - x[i], by = t[1][1] - y[i], bz = t[1][2] - z[i];
      const double cx = t[2][0] - x[i], cy = t[2][1] - y[i], cz = t[2][2] - z[i];
      const double a = std::sqrt(ax * ax + ay * ay + az * az);
      const double b = std::sqrt(bx * bx + by * by + bz * bz);
      const double c = std::sqrt(cx * cx + cy * cy + cz * cz);
      // The determinant by the edges at the first corner: it then loses nothing far away.
      const double ux = bx - ax, uy = by - ay, uz = bz - az;
      const double vx = cx - ax, vy = cy - ay, vz = cz - az;
      const double num =
          ax * (uy * vz - uz * vy) + ay * (uz * vx - ux * vz) + az * (ux * vy - uy * vx);
      const double den = a * b * c + (ax * bx + ay * by + az * bz) * c +
                         (bx * cx + by * cy + bz * cz) * a + (cx * ax + cy * ay + cz * az) * b;
      // A point at a corner has 0, 0.
      const bool atCorner = num == 0 && den == 0;
      const double p = atCorner ? 1 : den, q = num;
      const double nextRe = re[i] * p - im[i] * q;
      const double nextIm = re[i] * q + im[i] * p;
      // Both arguments in [0, pi] and their sum beyond pi; or both below 0 and beyond -pi.
      const bool above = im[i] >= 0 && q >= 0 && nextIm < 0;
      const bool below = im[i] < 0 && q < 0 && nextIm >= 0;
      turns[i] += (above ? 1.0 : 0.0) - (below ? 1.0 : 0.0);
      // The size does not matter, but must stay in range.
      const double next = 1 / (std::abs(nextRe) + std::abs(nextIm));
      re[i] = nextRe * next;
      im[i] = nextIm * next;
    }
  }
  constexpr double kPi = 3.14159265358979323846;
  // Twice the argument is the solid angle, of which 4 pi are one time around.
  for (std::size_t i = 0; i < kLanes; ++i)
    winding[i] = turns[i] + std::atan2(im[i], re[i]) / (2 * kPi);
}

} // namespace solid_angles
