// SPDX-License-Identifier: Apache-2.0
//
// The sub-voxel lattice: vertices are snapped to it once, and every later decision is exact on it.
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/core/Vec3.h"

#include <cmath>
#include <cstdint>

namespace tetvdb {

constexpr int kLatticeBits = 20;
constexpr std::int64_t kUnitsPerVoxel = std::int64_t(1) << kLatticeBits;
constexpr double kVoxelsPerUnit = 1.0 / static_cast<double>(kUnitsPerVoxel);

/// Longest extent of a tet along an axis, in lattice units (2^20 voxels).
constexpr double kMaxTetExtent = static_cast<double>(std::int64_t(1) << 40);

/// A lattice point. The coordinates are integers below 2^52 in absolute value, so a double holds
/// each exactly, and so do the differences.
struct LatticePoint {
  double x, y, z;
};

/// World to lattice along one axis, in IEEE doubles in this order: the same number on every machine
/// and device that does not fuse or reorder operations.
TETVDB_HD inline double snapToLattice(double world, double origin, double voxelSize) {
  return static_cast<double>(
      std::llrint((world - origin) / voxelSize * static_cast<double>(kUnitsPerVoxel)));
}

/// First voxel centre at or above a lattice coordinate.
TETVDB_HD inline std::int64_t ceilVoxel(double lattice) {
  const auto v = static_cast<std::int64_t>(lattice);
  return (v + kUnitsPerVoxel - 1) >> kLatticeBits;
}

/// Last voxel centre at or below a lattice coordinate.
TETVDB_HD inline std::int64_t floorVoxel(double lattice) {
  return static_cast<std::int64_t>(lattice) >> kLatticeBits;
}

} // namespace tetvdb
