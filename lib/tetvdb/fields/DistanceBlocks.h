// SPDX-License-Identifier: Apache-2.0
//
// Distances from every voxel of a box to the nearest of many faces, however far that is.
//
//   const tetvdb::DistanceBlocks blocks(mesh, faces);
//   blocks.rasterize(box, [&](const openvdb::Coord& leaf, const float* squared) { ... }, progress);
//
// The box is halved down to blocks of 4^3 voxels. Each block has a list of the faces that can be
// the nearest of one of its voxels: of its parent's list, those are left out whose bounding box has
// no point nearer to any voxel of the block than p, the point nearest to the block's middle. For a
// voxel v and a point q, |v - p|^2 - |v - q|^2 is largest, over the q of a box, a convex function
// of v along each axis on its own: six evaluations decide for all voxels of the block. What remains
// is evaluated, so that distances are exact.
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

/// Refers to mesh and faces, of which there is one at least. Voxels are taken for cubes; faces of
/// no area count as the segments or points that they are.
class DistanceBlocks {
public:
  /// 48 bytes a face.
  DistanceBlocks(const SnappedMesh& mesh, const Boundary& faces);

  /// Receives a leaf: its first voxel, and the squared distance of every voxel, voxels,
  /// [(x * 8 + y) * 8 + z]; those outside of the box have no meaning.
  using LeafSink = std::function<void(const Vec3i& first, const float* squared)>;

  /// Hands every leaf that meets the box to `sink`, each once, from several threads. Distances are
  /// within 1e-9 voxels of the snapped faces', and squares of them then rounded to single
  /// precision. They depend on the faces as a set alone. Cost: 100 to 200 ns a voxel, growing with
  /// the number of faces that are about equally near. Throws Error(Cancelled).
  void rasterize(const VoxelBox& box, const LeafSink& sink, Progress& progress) const;

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
