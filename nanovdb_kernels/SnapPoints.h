// SPDX-License-Identifier: Apache-2.0
//
// The points of a mesh on the lattice, and their box.
#pragma once

#include "DeviceVoxelizer.h"
#include "RasterizeFaces.h"

namespace tetvdb::nano {

constexpr double kMaxVoxel = 2147475456.0; // as SnappedMesh.cpp has it

/// What the first steps find, read together.
struct Findings {
  i64 low[3], high[3]; ///< box of the points, lattice units
  u64 flipped, flat;
  u64 openEdges, oddEdges;
  u32 errors, unused;
};

struct SnapShared {
  static constexpr int kThreads = 256, kOccupancy = 16;
  i64 low[3], high[3];
};

/// Snaps the points of `mesh`, which lie where the backend computes; `findings`, the backend's,
/// receive their box and kBadPoint.
template <typename Backend>
const LatticePoint* snapPoints(Backend& b, const MeshView& mesh, const Job& job,
                               Findings* findings) {
  const u64 n = mesh.pointCount;
  LatticePoint* points = b.template alloc<LatticePoint>(n);
  const double* world = mesh.points;
  const double ox = job.origin[0], oy = job.origin[1], oz = job.origin[2];
  const double hx = job.voxelSize[0], hy = job.voxelSize[1], hz = job.voxelSize[2];
  u32* errors = &findings->errors;
  // Enough teams for all multiprocessors first.
  const u64 perTeam = n < (u64(1) << 20) ? 256 : 2048;
  b.template forTeams<SnapShared>(
      (n + perTeam - 1) / perTeam, 256, TETVDB_KERNEL(const Team& team, u64 part, SnapShared& s) {
        if (team.rank() == 0)
          for (int k = 0; k < 3; ++k) {
            s.low[k] = i64(1) << 62;
            s.high[k] = -(i64(1) << 62);
          }
        team.sync();
        i64 low[3] = {i64(1) << 62, i64(1) << 62, i64(1) << 62};
        i64 high[3] = {-(i64(1) << 62), -(i64(1) << 62), -(i64(1) << 62)};
        const u64 end = (part + 1) * perTeam < n ? (part + 1) * perTeam : n;
        for (u64 i = part * perTeam + static_cast<u64>(team.rank()); i < end;
             i += static_cast<u64>(team.size())) {
          const double p[3] = {world[3 * i], world[3 * i + 1], world[3 * i + 2]};
          const bool inside = absolute((p[0] - ox) / hx) < kMaxVoxel &&
                              absolute((p[1] - oy) / hy) < kMaxVoxel &&
                              absolute((p[2] - oz) / hz) < kMaxVoxel;
          if (!inside) { // or not a number
            orInto(errors, u32(kBadPoint));
            points[i] = {0, 0, 0};
            continue;
          }
          const LatticePoint q{snapToLattice(p[0], ox, hx), snapToLattice(p[1], oy, hy),
                               snapToLattice(p[2], oz, hz)};
          points[i] = q;
          const i64 c[3] = {static_cast<i64>(q.x), static_cast<i64>(q.y), static_cast<i64>(q.z)};
          for (int k = 0; k < 3; ++k) {
            low[k] = c[k] < low[k] ? c[k] : low[k];
            high[k] = c[k] > high[k] ? c[k] : high[k];
          }
        }
        for (int k = 0; k < 3; ++k)
          if (low[k] <= high[k]) {
            minInto(&s.low[k], low[k]);
            maxInto(&s.high[k], high[k]);
          }
        team.sync();
        for (int k = team.rank(); k < 3; k += team.size()) {
          minInto(&findings->low[k], s.low[k]);
          maxInto(&findings->high[k], s.high[k]);
        }
        team.sync();
      });
  return points;
}

} // namespace tetvdb::nano
