// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/LargeVector.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/Lattice.h"
#include "tetvdb/geometry/TetBox.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

struct WorldBox; // voxelize/ChooseTransform.h

/// A tet mesh with its vertices on the sub-voxel lattice. Refers to the tets of the mesh it was
/// made from.
struct SnappedMesh {
  /// One more than the mesh has, so that a point can be read as four numbers.
  LargeVector<LatticePoint> points;
  std::size_t pointCount = 0;
  const std::uint32_t* tets = nullptr; ///< four indices each
  std::size_t tetCount = 0;
  /// Box of the points, lattice units.
  LatticePoint boxMin{0, 0, 0}, boxMax{0, 0, 0};
};

inline LatticePoint snapPoint(const Vec3d& p, const GridTransform& transform) {
  const Vec3d& o = transform.origin;
  const Vec3d& h = transform.voxelSize;
  return {snapToLattice(p[0], o[0], h[0]), snapToLattice(p[1], o[1], h[1]),
          snapToLattice(p[2], o[2], h[2])};
}

/// The box of snapped points from their own, since snapping keeps the order of coordinates. Throws
/// Error(Limit) for a box that leaves 32-bit index space.
LatticeBox snapBox(const WorldBox& box, const GridTransform& transform);

/// Snaps the points of `mesh` by `transform`, in parallel. Throws Error(Invalid) for a coordinate
/// that is not finite, Error(Limit) for one outside 32-bit index space.
SnappedMesh snapMesh(const TetMesh& mesh, const GridTransform& transform, Progress& progress);

/// The same for points alone: the result has no tets.
SnappedMesh snapPoints(const std::vector<Vec3d>& points, const GridTransform& transform,
                       Progress& progress);

} // namespace tetvdb
