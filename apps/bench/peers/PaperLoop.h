// SPDX-License-Identifier: Apache-2.0
//
// The peers that test every voxel of every tet's bounding box: the paper's loop into a dense grid,
// and the same loop through an OpenVDB accessor.
#pragma once

#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb::bench {

/// Voxel centres within a mesh's box.
struct VoxelBox {
  Vec3i min{0, 0, 0};
  Vec3i size{0, 0, 0}; ///< centres along each axis

  std::size_t count() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
           static_cast<std::size_t>(size[2]);
  }
};

VoxelBox voxelBox(const TetMesh& mesh, const GridTransform& transform);

/// A dense grid, value type uint8 (1 inside, 0 outside) or int32 (the tet, -1 outside). Its memory
/// is taken once and cleared in every run: to the loop's advantage, for fresh memory costs more.
template <typename Value>
class PaperLoop {
public:
  PaperLoop(const TetMesh& mesh, const GridTransform& transform);
  /// Points into index space, grid cleared, all tets. OpenMP, schedule(dynamic, 1024).
  void run();
  std::size_t activeVoxels() const;

private:
  const TetMesh& mesh_;
  GridTransform transform_;
  VoxelBox box_;
  std::vector<Vec3d> points_;
  std::vector<Value> grid_;
};

/// One thread, every voxel found inside written through a ValueAccessor of a BoolGrid; a voxel on a
/// tile or in a leaf costs the same. Returns the number of active voxels.
std::size_t accessorLoop(const TetMesh& mesh, const GridTransform& transform);

/// Threads that the loop uses; 1 where the compiler has no OpenMP.
void setLoopThreads(int threads);
bool haveOpenMP();

} // namespace tetvdb::bench
