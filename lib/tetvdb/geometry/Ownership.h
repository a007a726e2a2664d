// SPDX-License-Identifier: Apache-2.0
//
// The tet that owns a voxel centre.
//
// Let c be a voxel centre and c' = c + (e, e^2, e^3) with e -> 0+, one perturbed point that is the
// same for all tets. A tet owns c if c' is strictly inside it. No face plane contains c' (the curve
// (e, e^2, e^3) meets a plane through lattice points at finitely many e), so exactly one of the
// tets that tile a region owns each centre. In practice the four face values decide; if one is
// zero, the sign of the face's inward normal: its first non-zero component.
//
// The functions here are the definition, one centre at a time and exact. The rasterisers
// (TetRaster.h, FaceRaster.h) evaluate it by rows with filtered doubles; docs/algorithms.md has the
// proofs.
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/geometry/Exact.h"
#include "tetvdb/geometry/Lattice.h"
#include "tetvdb/geometry/RoundedDeterminant.h"

#include <array>
#include <cstdint>

namespace tetvdb {

/// Sign of n . (e, e^2, e^3) for e -> 0+: whether the perturbed centre moves into the half-space
/// with inward normal n if the centre lies on its plane. 0 only for n = 0.
template <typename T>
TETVDB_HD constexpr int tieSign(T nx, T ny, T nz) {
  if (nx != 0)
    return nx > 0 ? 1 : -1;
  if (ny != 0)
    return ny > 0 ? 1 : -1;
  if (nz != 0)
    return nz > 0 ? 1 : -1;
  return 0;
}

struct ExactVector {
  Int128 x, y, z;
};

TETVDB_HD inline ExactVector difference(const LatticePoint& a, const LatticePoint& b) {
  return {static_cast<std::int64_t>(a.x - b.x), static_cast<std::int64_t>(a.y - b.y),
          static_cast<std::int64_t>(a.z - b.z)};
}

TETVDB_HD inline ExactVector cross(const ExactVector& a, const ExactVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

TETVDB_HD inline Int128 dot(const ExactVector& a, const ExactVector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Normal of triangle abc: toward the side that sees a, b, c counter-clockwise.
TETVDB_HD inline ExactVector triangleNormal(const LatticePoint& a, const LatticePoint& b,
                                            const LatticePoint& c) {
  return cross(difference(b, a), difference(c, a));
}

/// Six times the signed volume of tet abcd: positive if d lies on the side of triangle abc to which
/// its normal points. Exact for extents up to kMaxTetExtent.
TETVDB_HD inline Int128 orientation(const LatticePoint& a, const LatticePoint& b,
                                    const LatticePoint& c, const LatticePoint& d) {
  return dot(triangleNormal(a, b, c), difference(d, a));
}

/// Sign of orientation(), by doubles if these decide.
TETVDB_HD inline int tetOrientation(const LatticePoint& a, const LatticePoint& b,
                                    const LatticePoint& c, const LatticePoint& d) {
  const RoundedDeterminant rounded(b.x - a.x, b.y - a.y, b.z - a.z, c.x - a.x, c.y - a.y, c.z - a.z,
                                   d.x - a.x, d.y - a.y, d.z - a.z);
  const int sign = rounded.sign(RoundedDeterminant::kOfExact);
  return sign != 0 ? sign : signOf(orientation(a, b, c, d));
}

/// Lattice point of a voxel centre.
inline LatticePoint voxelCentre(const Vec3i& voxel) {
  return {static_cast<double>(voxel[0]) * static_cast<double>(kUnitsPerVoxel),
          static_cast<double>(voxel[1]) * static_cast<double>(kUnitsPerVoxel),
          static_cast<double>(voxel[2]) * static_cast<double>(kUnitsPerVoxel)};
}

/// Side of the perturbed centre with respect to the plane of triangle abc: +1 on the side of its
/// normal, -1 on the other, 0 only for a degenerate triangle.
TETVDB_HD inline int perturbedSide(const LatticePoint& a, const LatticePoint& b,
                                   const LatticePoint& c, const LatticePoint& centre) {
  const ExactVector n = triangleNormal(a, b, c);
  const int sign = signOf(dot(n, difference(centre, a)));
  return sign != 0 ? sign : tieSign(n.x, n.y, n.z);
}

/// Whether the tet, of either orientation, owns the voxel. A flat tet owns nothing. The centre must
/// be within kMaxTetExtent of the tet.
inline bool ownsVoxel(const std::array<LatticePoint, 4>& tet, const Vec3i& voxel) {
  const int o = signOf(orientation(tet[0], tet[1], tet[2], tet[3]));
  if (o == 0)
    return false;
  const LatticePoint c = voxelCentre(voxel);
  // The faces, each with the opposite vertex on the side of the normal if o > 0.
  return perturbedSide(tet[0], tet[1], tet[2], c) == o &&
         perturbedSide(tet[0], tet[3], tet[1], c) == o &&
         perturbedSide(tet[0], tet[2], tet[3], c) == o &&
         perturbedSide(tet[1], tet[3], tet[2], c) == o;
}

} // namespace tetvdb
