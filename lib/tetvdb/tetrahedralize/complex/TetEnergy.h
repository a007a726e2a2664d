// SPDX-License-Identifier: Apache-2.0
//
// How far a tet is from regular.
//
// The AMIPS energy tr(J^T J) / det(J)^(2/3), J being the map from the regular tet ("Computing
// Locally Injective Mappings by Advanced MIPS", Fu, Liu, Guo 2015), needs no J: the sum P
// of the squared lengths of six edges is proportional to the trace, as those of the regular tet add
// up to a multiple of the identity. With six times the volume as det, energy^3 = P^3 / (16 det^2):
// 3 for the regular tet.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace tetvdb {

/// Above this the determinant of an energy is computed exactly. Below, ten digits are right: the
/// determinant is P^1.5 / (4 E^1.5) for energy E, and its error within 1e-15 P^1.5.
constexpr double kRoughEnergy = 1e4;

/// The squared lengths' sum and the determinant of the tet (p, a, b, c).
struct TetShape {
  double squares, det;

  TetShape(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d u = minus(a, p), v = minus(b, p), w = minus(c, p);
    const Vec3d sum = plus(plus(u, v), w);
    squares = 4 * (dot(u, u) + dot(v, v) + dot(w, w)) - dot(sum, sum);
    det = dot(w, cross(u, v));
  }
  double cube() const { return squares * squares * squares / (16 * det * det); }
};

/// The cube of the energy of a tet of lattice points; infinity where it is not positive.
inline double energyCube(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  TetShape shape(a, b, c, d);
  constexpr double kRoughCube = kRoughEnergy * kRoughEnergy * kRoughEnergy;
  if (!(shape.det > 0) || shape.cube() > kRoughCube)
    shape.det = exactDeterminant(a, b, c, d);
  return shape.det > 0 ? shape.cube() : std::numeric_limits<double>::infinity();
}

inline double tetEnergy(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  return std::cbrt(energyCube(a, b, c, d));
}

/// Whether tets (p, a, b, c) are positive and of no more than a given energy: the most frequent
/// query of candidates.
class EnergyLimit {
public:
  explicit EnergyLimit(double energy)
      : energy_(energy), cube16_(16 * cubed(std::min(energy, kRoughEnergy))) {}

  double energy() const { return energy_; }
  /// `weight` is that of TetComplex::Tet, cubed.
  bool allows(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c,
              double weight = 1) const {
    // A tet of low energy is positive in spite of rounding.
    const TetShape shape(p, a, b, c);
    if (shape.det > 0 && weight * cubed(shape.squares) <= cube16_ * (shape.det * shape.det))
      return true;
    return energy_ > kRoughEnergy && tetEnergy(p, a, b, c) * std::cbrt(weight) <= energy_;
  }

private:
  static double cubed(double x) { return x * x * x; }

  double energy_, cube16_;
};

/// The cube of a weight, as energies' cubes have it.
inline double cubedWeight(const TetComplex::Tet& tet) {
  const double weight = tet.weight;
  return weight * weight * weight;
}

/// The tet's energy times its weight, cached until it changes.
inline float energyOf(TetComplex& complex, std::uint32_t t) {
  TetComplex::Tet& tet = complex.tets[t];
  if (tet.energy == 0)
    tet.energy = static_cast<float>(
        std::min(tet.weight * tetEnergy(complex.at(tet.corners[0]), complex.at(tet.corners[1]),
                                        complex.at(tet.corners[2]), complex.at(tet.corners[3])),
                 static_cast<double>(std::numeric_limits<float>::max())));
  return tet.energy;
}

/// Tets above `energy` and of no less than a weight, with their energies, the worst first, that
/// have a point at which `bit` of Point::changed is set; clears that bit everywhere.
inline std::vector<std::pair<float, std::uint32_t>>
takeChangedTets(TetComplex& complex, std::uint8_t bit, double energy, double minWeight) {
  std::vector<std::pair<float, std::uint32_t>> taken;
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t) {
    const TetComplex::Tet& tet = complex.tets[t];
    if (!tet.exists() || tet.weight < minWeight)
      continue;
    const bool changed =
        std::any_of(tet.corners.begin(), tet.corners.end(), [&](std::uint32_t corner) {
          return (complex.points[corner].changed & bit) != 0;
        });
    if (changed && energyOf(complex, t) > energy)
      taken.emplace_back(tet.energy, t);
  }
  for (TetComplex::Point& point : complex.points)
    point.clearChanged(bit);
  std::sort(taken.begin(), taken.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  return taken;
}

} // namespace tetvdb
