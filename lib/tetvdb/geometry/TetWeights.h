// SPDX-License-Identifier: Apache-2.0
//
// Barycentric weights of voxel centres in the tet that owns them, and values of point arrays by
// these weights. The same source, with the same bits, is used on the CPU and on a GPU.
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/geometry/Lattice.h"
#include "tetvdb/geometry/NearestDouble.h"
#include "tetvdb/geometry/Ownership.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// A tet prepared for weights. Its corners are used in order of position (x, then y, then z),
/// independent of their order in the mesh, so that renumbering changes no bit of a result.
class TetWeights {
public:
  TetWeights() = default;
  /// The tet whose corners are points[vertices[0]] to points[vertices[3]]; it must have volume.
  TETVDB_HD inline TetWeights(const LatticePoint* points, const std::uint32_t* vertices);

  /// Local indices of the corners, 0 to 3, in order of position.
  TETVDB_HD const std::array<std::uint8_t, 4>& corners() const { return corners_; }

  /// Weights of the second, third and fourth corner at the centre of voxel (x, y, z); the first has
  /// the remainder to 1. Computed on the lattice of snapped tets, so that all four are in [0, 1] up
  /// to rounding if the tet owns the voxel. Their error is 2^-30 relative to the tet's size:
  /// slivers, for which doubles do not suffice, are computed in 128-bit integers.
  TETVDB_HD std::array<double, 3> at(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const double d[3] = {static_cast<double>(x) * kUnits - points_[0].x,
                         static_cast<double>(y) * kUnits - points_[0].y,
                         static_cast<double>(z) * kUnits - points_[0].z};
    if (exact_)
      return exactAt(d);
    return {gradients_[0][0] * d[0] + gradients_[0][1] * d[1] + gradients_[0][2] * d[2],
            gradients_[1][0] * d[0] + gradients_[1][1] * d[1] + gradients_[1][2] * d[2],
            gradients_[2][0] * d[0] + gradients_[2][1] * d[1] + gradients_[2][2] * d[2]};
  }

private:
  static constexpr double kUnits = static_cast<double>(kUnitsPerVoxel);
  // In doubles, cross products and the determinant have a rounding error of at most 2^-48 size^3:
  // above this share of size^3, the error of a weight is 2^-30.
  static constexpr double kMinDeterminant = 0x1p-18;

  TETVDB_HD static double sizeOf(double v) { return v < 0 ? -v : v; }
  TETVDB_HD static bool isBefore(const LatticePoint& a, const LatticePoint& b) {
    if (a.x != b.x)
      return a.x < b.x;
    return a.y != b.y ? a.y < b.y : a.z < b.z;
  }
  // Sorts corners a < b.
  TETVDB_HD inline void order(std::size_t a, std::size_t b);
  TETVDB_HD inline std::array<double, 3> exactAt(const double (&d)[3]) const;

  LatticePoint points_[4] = {}; // in order of position
  double gradients_[3][3] = {}; // of the weights, per lattice unit
  std::array<std::uint8_t, 4> corners_{};
  bool exact_ = false;
};

TETVDB_HD inline void TetWeights::order(std::size_t a, std::size_t b) {
  if (!isBefore(points_[b], points_[a]))
    return;
  const LatticePoint point = points_[a];
  points_[a] = points_[b];
  points_[b] = point;
  const std::uint8_t corner = corners_[a];
  corners_[a] = corners_[b];
  corners_[b] = corner;
}

TETVDB_HD inline TetWeights::TetWeights(const LatticePoint* points, const std::uint32_t* vertices) {
  corners_ = {0, 1, 2, 3};
  for (std::size_t i = 0; i < 4; ++i)
    points_[i] = points[vertices[i]];
  order(0, 1);
  order(2, 3);
  order(0, 2);
  order(1, 3);
  order(1, 2);

  double e[3][3]; // differences of lattice points are exact
  double size = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    e[i][0] = points_[i + 1].x - points_[0].x;
    e[i][1] = points_[i + 1].y - points_[0].y;
    e[i][2] = points_[i + 1].z - points_[0].z;
    for (const double c : e[i])
      size = sizeOf(c) > size ? sizeOf(c) : size;
  }
  for (std::size_t i = 0; i < 3; ++i) { // the cross product of the other two
    const double(&a)[3] = e[(i + 1) % 3], (&b)[3] = e[(i + 2) % 3];
    gradients_[i][0] = a[1] * b[2] - a[2] * b[1];
    gradients_[i][1] = a[2] * b[0] - a[0] * b[2];
    gradients_[i][2] = a[0] * b[1] - a[1] * b[0];
  }
  const double determinant =
      e[0][0] * gradients_[0][0] + e[0][1] * gradients_[0][1] + e[0][2] * gradients_[0][2];
  exact_ = !(sizeOf(determinant) > kMinDeterminant * size * size * size);
  for (auto& gradient : gradients_)
    for (double& g : gradient)
      g /= determinant;
}

// By Cramer's rule: the weight of a corner is the volume with the centre instead of it.
TETVDB_HD inline std::array<double, 3> TetWeights::exactAt(const double (&d)[3]) const {
  const LatticePoint centre{points_[0].x + d[0], points_[0].y + d[1], points_[0].z + d[2]};
  const LatticePoint(&p)[4] = points_;
  const double whole = nearestDouble(orientation(p[0], p[1], p[2], p[3]));
  return {nearestDouble(orientation(p[0], centre, p[2], p[3])) / whole,
          nearestDouble(orientation(p[0], p[1], centre, p[3])) / whole,
          nearestDouble(orientation(p[0], p[1], p[2], centre)) / whole};
}

/// `corners`: the value at the first corner by position, and the differences at the others.
TETVDB_HD inline double interpolate(const std::array<double, 4>& corners,
                                    const std::array<double, 3>& w) {
  return corners[0] + (w[0] * corners[1] + w[1] * corners[2] + w[2] * corners[3]);
}

/// The corner by position with the largest weight, the first of several.
TETVDB_HD inline std::size_t nearestCorner(const std::array<double, 3>& w) {
  std::size_t nearest = 0;
  double max = 1 - (w[0] + w[1] + w[2]);
  for (std::size_t i = 0; i < 3; ++i)
    if (w[i] > max) {
      max = w[i];
      nearest = i + 1;
    }
  return nearest;
}

} // namespace tetvdb
