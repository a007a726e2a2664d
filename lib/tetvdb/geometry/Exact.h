// SPDX-License-Identifier: Apache-2.0
//
// Exact integer arithmetic on the sub-voxel lattice.
#pragma once

#include "tetvdb/core/HostDevice.h"

#include <cstdint>

namespace tetvdb {

/// 128 bits hold every value of this library exactly: for a tet of extent L (lattice units), a face
/// value is at most 2 L^3, and L <= 2^40 (2^20 voxels of 2^20 units).
__extension__ typedef __int128 Int128;

TETVDB_HD inline int signOf(Int128 v) {
  return (v > 0) - (v < 0);
}
TETVDB_HD inline int signOf(double v) {
  return (v > 0) - (v < 0);
}

/// Largest integer not above num / den, den > 0.
TETVDB_HD inline Int128 floorDivide(Int128 num, Int128 den) {
  const Int128 q = num / den;
  return q * den > num ? q - 1 : q;
}

/// Smallest integer not below num / den, den > 0.
TETVDB_HD inline Int128 ceilDivide(Int128 num, Int128 den) {
  const Int128 q = num / den;
  return q * den < num ? q + 1 : q;
}

} // namespace tetvdb
