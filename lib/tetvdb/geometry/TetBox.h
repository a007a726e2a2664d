// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/geometry/Lattice.h"

#include <algorithm>
#include <cstdint>

namespace tetvdb {

/// The box of a tet's corners, lattice units.
struct LatticeBox {
  LatticePoint low, high;

  /// Along its longest axis.
  TETVDB_HD double extent() const {
    return std::max(std::max(high.x - low.x, high.y - low.y), high.z - low.z);
  }
};

TETVDB_HD inline LatticeBox boxOf(const LatticePoint& a, const LatticePoint& b,
                                  const LatticePoint& c, const LatticePoint& d) {
  const auto least = [](double p, double q, double r, double s) {
    return std::min(std::min(p, q), std::min(r, s));
  };
  const auto most = [](double p, double q, double r, double s) {
    return std::max(std::max(p, q), std::max(r, s));
  };
  return {
      {least(a.x, b.x, c.x, d.x), least(a.y, b.y, c.y, d.y), least(a.z, b.z, c.z, d.z)},
      {most(a.x, b.x, c.x, d.x), most(a.y, b.y, c.y, d.y), most(a.z, b.z, c.z, d.z)},
  };
}

/// Inclusive box of the voxel centres within the box of a tet; empty if min > max.
struct TetBox {
  std::int64_t min[3], max[3];
  TETVDB_HD bool empty() const { return min[0] > max[0] || min[1] > max[1] || min[2] > max[2]; }
  /// Whether it spans three nodes or more along an axis, so that a node may be entirely inside or
  /// outside of the enclosed body.
  bool spansNodes() const {
    const auto spans = [&](int k) { return (max[k] >> 7) - (min[k] >> 7) >= 2; };
    return spans(0) || spans(1) || spans(2);
  }
};

TETVDB_HD inline TetBox voxelBox(const LatticeBox& box) {
  return {{ceilVoxel(box.low.x), ceilVoxel(box.low.y), ceilVoxel(box.low.z)},
          {floorVoxel(box.high.x), floorVoxel(box.high.y), floorVoxel(box.high.z)}};
}

} // namespace tetvdb
