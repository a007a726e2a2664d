// SPDX-License-Identifier: Apache-2.0
//
// Surfaces of which no point is nearer to another surface than a distance, with proof.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/Volume.h"

namespace tetvdb {

/// A distance that a surface keeps from another one.
struct Guard {
  /// Of every voxel a number that is not above the squared distance to the other surface, voxels,
  /// and within SolidDistances's error where the distance is from insideFrom() - voxel to
  /// insideFrom() + voxel; 0 where nothing may be.
  const openvdb::FloatGrid& squared;
  double distance; ///< world units, two voxels or more
  double voxel;    ///< world units
  double rounding; ///< world units, by which coordinates may be rounded later

  /// World units: what vertices are away from the other surface. With d(x) the distance, d^2(x) -
  /// |x|^2 is a minimum of linear functions, and so concave: at a point p of a triangle with
  /// corners v_i and barycentric coordinates w_i, d^2(p) >= sum w_i d^2(v_i) - sum w_i |v_i - p|^2,
  /// and the last sum is at most the square of the radius of a ball around the triangle: 3/4
  /// voxel^2, as triangles lie in cubes of voxels.
  double ofVertices() const;
  /// World units: what the centres of voxels inside the surface are away from it, so that a vertex
  /// may lie a twentieth of a voxel from them.
  double insideFrom() const;
};

struct GuardedSurface {
  TriangleMesh mesh;
  double distance = 0; ///< world units: no point of it is nearer to the other surface; proven
};

/// The surface of what is below 0 in `shape`, a level set with a transform, in voxels, of which all
/// that are below 0 are insideFrom() away. On the way from a voxel inside to one outside a
/// vertex lies where `limit`, a level set in voxels too, passes 0 between them, or at the guard's
/// distance, whichever comes first; `limit` may be null. How far vertices are from the other
/// surface follows from the two voxels: by concavity at least the root of what is between their
/// squares less t (1 - t) voxel^2. Closed, oriented and manifold as by marchCubes(), whose errors
/// it throws; empty where nothing is inside.
GuardedSurface guardedSurface(const openvdb::FloatGrid::Ptr& shape, const openvdb::FloatGrid* limit,
                              const Guard& guard, Progress& progress);

} // namespace tetvdb
