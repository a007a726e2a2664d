// SPDX-License-Identifier: Apache-2.0
//
// Surfaces with a proven minimum distance from another surface.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/Volume.h"

namespace tetvdb {

/// A distance that a surface keeps from another one.
struct Guard {
  /// For every voxel, a lower bound of the squared distance to the other surface, in voxels, within
  /// SolidDistances's error if the distance is from insideFrom() - voxel to insideFrom() + voxel; 0
  /// where nothing may be.
  const openvdb::FloatGrid& squared;
  double distance; ///< world units, two voxels or more
  double voxel;    ///< world units
  double rounding; ///< world units, error of later rounding of coordinates

  /// World units: the distance of vertices from the other surface. With d(x) the distance, d^2(x) -
  /// |x|^2 is a minimum of linear functions and therefore concave: at a point p of a triangle with
  /// corners v_i and barycentric coordinates w_i, d^2(p) >= sum w_i d^2(v_i) - sum w_i |v_i - p|^2,
  /// and the last sum is at most the squared radius of a ball around the triangle: 3/4 voxel^2,
  /// since triangles lie in cubes of voxels.
  double ofVertices() const;
  /// World units: the minimum distance of the centres of voxels inside the surface, so that a
  /// vertex may lie a twentieth of a voxel from them.
  double insideFrom() const;
};

struct GuardedSurface {
  TriangleMesh mesh;
  double distance = 0; ///< world units: proven minimum distance from the other surface
};

/// Returns the surface of the region below 0 of `shape`, a level set with a transform, in voxels.
/// All of its inside voxels must be at insideFrom() or farther. Between an inside and an outside
/// voxel, a vertex lies where `limit`, also a level set in voxels, passes 0, or at the guard's
/// distance, whichever comes first; `limit` may be null. The distance of vertices from the other
/// surface is bounded by the two voxels: by concavity it is at least the root of the interpolation
/// of their squares minus t (1 - t) voxel^2. Closed, oriented and manifold as by marchCubes(),
/// whose errors it throws; empty if nothing is inside.
GuardedSurface guardedSurface(const openvdb::FloatGrid::Ptr& shape, const openvdb::FloatGrid* limit,
                              const Guard& guard, Progress& progress);

} // namespace tetvdb
