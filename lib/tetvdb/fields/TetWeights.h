// SPDX-License-Identifier: Apache-2.0
//
// Barycentric weights of voxel centres in the tet that owns them.
#pragma once

#include "tetvdb/voxelize/SnappedMesh.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// A tet made ready for weights. Its corners are taken in order of position (x, then y, then z),
/// whatever their order in the mesh, so that renumbering changes no bit of a result.
class TetWeights {
public:
  TetWeights() = default;
  /// Tet `tet` of `mesh`, which must have volume.
  TetWeights(const SnappedMesh& mesh, std::size_t tet);

  /// Corners by their place in the tet, 0 to 3, in order of position.
  const std::array<std::uint8_t, 4>& corners() const { return corners_; }

  /// Weights of the second, third and fourth corner at the centre of voxel (x, y, z); the first has
  /// what is left to 1. On the lattice that tets are snapped to, so that for a voxel that the tet
  /// owns all four are in [0, 1] but for rounding. Relative to the tet's size they are good to
  /// 2^-30: slivers, where doubles would not do, are computed in 128-bit integers.
  std::array<double, 3> at(std::int32_t x, std::int32_t y, std::int32_t z) const {
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
  std::array<double, 3> exactAt(const double (&d)[3]) const;

  std::array<LatticePoint, 4> points_{}; // in order of position
  double gradients_[3][3] = {};          // of the weights, per lattice unit
  std::array<std::uint8_t, 4> corners_{};
  bool exact_ = false;
};

} // namespace tetvdb
