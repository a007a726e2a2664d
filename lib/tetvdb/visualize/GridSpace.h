// SPDX-License-Identifier: Apache-2.0
//
// Rays and normals between the world and a grid's index space.
#pragma once

#include "tetvdb/visualize/ActiveTree.h"

#include <openvdb/math/Transform.h>

namespace tetvdb {

class GridSpace {
public:
  /// Any affine map; Error(Invalid) for others (frustums).
  explicit GridSpace(const openvdb::math::Transform& transform);

  /// The same t. Voxel (i, j, k) takes up [i, i + 1).
  IndexRay toIndex(const Ray& ray) const;
  /// Of a point.
  Vec3d toIndex(const Vec3d& world) const;
  Vec3d toWorld(const Vec3d& index) const;
  /// From a gradient in index space, of length 1; zero stays zero.
  Vec3d normal(const Vec3d& gradient) const;
  /// The box of the voxels from `low` to `high`, inclusive.
  Box bounds(const Vec3i& low, const Vec3i& high) const;
  /// How far the tree's active voxels reach in a direction, in the world (Drawable::support()).
  double support(const ActiveTree& tree, const Vec3d& direction) const;
  /// Adds the tree's leaf nodes and active tiles to the map, each a voxel larger on all sides.
  /// Parallel.
  void mark(const ActiveTree& tree, EntryMap& map) const;
  /// The shortest side of a voxel, world units.
  double voxel() const { return voxel_; }

private:
  using Matrix = std::array<Vec3d, 3>; ///< rows
  Matrix toIndex_{}, toWorld_{};
  Vec3d origin_{}; ///< of index (0, 0, 0), the corner of a voxel
  double voxel_ = 1;
};

} // namespace tetvdb
