// SPDX-License-Identifier: Apache-2.0
//
// Distances from every voxel of a box to the nearest of many faces, without a limit.
//
//   const tetvdb::DistanceBlocks blocks(mesh, faces);
//   blocks.rasterize(box, [&](const openvdb::Coord& leaf, const float* squared) { ... }, progress);
//
// The box is halved down to blocks of 4^3 voxels. Each block has a list of the faces that can be
// the nearest of one of its voxels: its parent's list without those whose bounding box has no point
// nearer to any voxel of the block than p, the point nearest to the block's centre. For a voxel v
// and a point q of a box, the maximum of |v - p|^2 - |v - q|^2 over q is a convex function of v
// along each axis separately: six evaluations decide for all voxels of the block. The remaining
// faces are evaluated, so that distances are exact.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/LeafDistance.h"
#include "tetvdb/volume/VoxelBox.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace tetvdb {

/// Refers to mesh and at least one face. Voxels are treated as cubes; faces without area as
/// segments or points.
class DistanceBlocks {
public:
  /// 48 bytes per face.
  DistanceBlocks(const SnappedMesh& mesh, const Boundary& faces);

  /// Receives a leaf: its first voxel, and the squared distance of every voxel, voxels, [(x * 8 +
  /// y) * 8 + z]; those outside of the box are undefined.
  using LeafSink = std::function<void(const Vec3i& first, const float* squared)>;

  /// Passes each leaf that meets the box to `sink` once, from several threads. Distances are those
  /// of the snapped faces within 1e-9 voxels; their squares are then rounded to single precision.
  /// They depend on the faces as a set only. Cost: 100 to 200 ns per voxel, increasing with the
  /// number of faces at nearly equal distance. Throws Error(Cancelled).
  void rasterize(const VoxelBox& box, const LeafSink& sink, Progress& progress) const;

  /// The largest square of a voxel in the box that rasterize() would pass. From one voxel to
  /// another distances change by at most the way between them: only blocks are halved whose middle
  /// allows a larger one than what is known of others. Throws Error(Cancelled).
  float largest(const VoxelBox& box, Progress& progress) const;

private:
  struct FaceBox {
    Vec3d low, high;
  };
  struct Block;
  class Run;

  const SnappedMesh& mesh_;
  const Boundary& faces_;
  std::vector<FaceBox> boxes_; ///< voxels
};

} // namespace tetvdb
