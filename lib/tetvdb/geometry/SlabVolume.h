// SPDX-License-Identifier: Apache-2.0
//
// What a face adds to the volumes of voxels in a slab, 8 x 128 x 128 of them: in each voxel's cube
// the volume above the face, and its area seen along z, which is the volume added to each higher
// voxel. Both are integers, so that sums do not depend on the order of faces. The same source, with
// the same bits, is used on the CPU and on a GPU.
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/ClippedFace.h"
#include "tetvdb/geometry/NodeIndex.h"
#include "tetvdb/geometry/VectorMath.h"

#include <cmath>
#include <cstdint>
#include <tuple>

namespace tetvdb {

/// A voxel's volume is so many. Up to 2^17 solids may overlap.
constexpr std::int64_t kWholeVolume = std::int64_t(1) << 46;
/// Sums as near as this to whole volumes are whole.
constexpr std::int64_t kSnapVolume = kWholeVolume >> 32;
/// What closed faces may leave above the last of them: rounding errors.
constexpr std::int64_t kOpenVolume = kWholeVolume >> 20;

constexpr int kLeavesInSlab = (kNodeSize / kLeafSize) * (kNodeSize / kLeafSize); ///< y, z
/// A leaf's volumes, [(x * 8 + y) * 8 + z], and then its areas.
constexpr int kSumsOfLeaf = 2 * kLeafSize * kLeafSize * kLeafSize;

/// Columns of a slab, leaf by leaf: (x, y) at y / 8 * 64 + x * 8 + y % 8.
constexpr int kColumnsInLeaf = kLeafSize * kLeafSize;
constexpr int kColumnsInSlab = kColumnsInLeaf * (kNodeSize / kLeafSize);

/// A slab of a node, and a face that may pass through it. x in slabs of 8, y and z in nodes.
struct FaceInSlab {
  std::int32_t x, y, z;
  std::uint32_t face;
  bool operator<(const FaceInSlab& o) const {
    return std::tie(x, y, z, face) < std::tie(o.x, o.y, o.z, o.face);
  }
  Vec3i key() const { return {x, y, z}; }
  TETVDB_HD bool sameStack(const FaceInSlab& o) const { return x == o.x && y == o.y; }
};

/// A corner relative to the slab's first cube. `point`: in coordinates in which the cube of voxel i
/// is [i, i + 1].
TETVDB_HD inline Vec3d inSlab(const Vec3d& point, const FaceInSlab& at) {
  return {point[0] - static_cast<double>(at.x) * kLeafSize,
          point[1] - static_cast<double>(at.y) * kNodeSize,
          point[2] - static_cast<double>(at.z) * kNodeSize};
}

/// The face in the slab, its corners in order of position, so that numbers do not depend on the
/// order of corners; `sign` is what its sums count: outside is above.
TETVDB_HD inline Polygon polygonInSlab(const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                       std::int32_t weight, const FaceInSlab& at, double& sign) {
  const Vec3d* p[3] = {&a, &b, &c};
  sign = -weight;
  const auto order = [&](int i, int k) {
    if (!comesBefore(*p[k], *p[i]))
      return;
    const Vec3d* const first = p[i];
    p[i] = p[k];
    p[k] = first;
    sign = -sign;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  Polygon polygon;
  for (const Vec3d* corner : p) {
    const Vec3d at0 = inSlab(*corner, at);
    const double numbers[3] = {at0[0], at0[1], at0[2]};
    polygon.add(numbers);
  }
  return polygon;
}

/// Calls add(leaf, voxel, volume, area) for every voxel that a face's part in layer x of the slab
/// meets: leaf y / 8 * 16 + z / 8, voxel (x * 8 + y % 8) * 8 + z % 8.
template <typename Add>
TETVDB_HD TETVDB_INLINE void addSlice(int x, const Polygon& slice, double sign, const Add& add) {
  cutAlong(slice, 1, 0, kNodeSize - 1, [&](int y, const Polygon& column) {
    cutAlong(column, 2, 0, kNodeSize - 1, [&](int z, const Polygon& piece) {
      double sum = 0, moment = 0;
      const double* o = piece.at[0];
      const double top = z + 1;
      for (int i = 1; i + 1 < piece.count; ++i) {
        const double *p = piece.at[i], *q = piece.at[i + 1];
        const double twice = (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
        sum += twice;
        moment += twice * ((top - o[2]) + (top - p[2]) + (top - q[2]));
      }
      constexpr auto whole = static_cast<double>(kWholeVolume);
      add((y >> 3) * (kNodeSize / kLeafSize) + (z >> 3), (x << 6) | ((y & 7) << 3) | (z & 7),
          std::int64_t(std::llrint(moment / 6 * sign * whole)),
          std::int64_t(std::llrint(sum / 2 * sign * whole)));
    });
  });
}

TETVDB_HD inline std::int64_t snapped(std::int64_t volume) {
  const std::int64_t nearest = (volume + kWholeVolume / 2) & -kWholeVolume, off = volume - nearest;
  return off >= -kSnapVolume && off <= kSnapVolume ? nearest : volume;
}

/// Volumes of a column of a leaf, which may be below 0 or above one. `sums`: the leaf's, from the
/// column's first voxel on; null where no face meets it. `carry` is the volume that the faces below
/// add to each voxel, and is set to that of the next leaf.
TETVDB_HD inline void sumColumn(const std::int64_t* sums, std::int64_t& carry, std::int64_t* out) {
  for (int z = 0; z < kLeafSize; ++z) {
    out[z] = snapped(sums == nullptr ? carry : carry + sums[z]);
    if (sums != nullptr)
      carry += sums[kSumsOfLeaf / 2 + z];
  }
  carry = snapped(carry);
}

/// Rounds the fractions of a leaf, in order, so that their sum is kept: of the two floats next to
/// one, the float that brings the sum of the errors nearer to 0.
class ShareRounding {
public:
  TETVDB_HD float operator()(std::int64_t volume) {
    const double fraction = static_cast<double>(volume) / static_cast<double>(kWholeVolume);
    const auto nearest = static_cast<float>(fraction);
    const double error = static_cast<double>(nearest) - fraction;
    if (error == 0)
      return nearest;
    const float other = ::nextafterf(nearest, error > 0 ? 0.0F : 1.0F);
    const double otherError = static_cast<double>(other) - fraction;
    const bool first = std::abs(off_ + error) <= std::abs(off_ + otherError);
    off_ += first ? error : otherError;
    return first ? nearest : other;
  }

private:
  double off_ = 0;
};

} // namespace tetvdb
