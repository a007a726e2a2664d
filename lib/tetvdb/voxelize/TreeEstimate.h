// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/volume/LevelsOfDetail.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

/// The expected number of nodes of a tree, an upper estimate.
struct TreeEstimate {
  double leaves = 0;
  double lowerNodes = 0;

  /// Memory of the trees of all `grids`.
  double bytes(const std::vector<GridKind>& grids) const;
  /// Memory of the levels of detail of so many grids, which are floats.
  double levelBytes(const LevelRange& levels, std::size_t grids) const;
};

/// The expected leaves of levels of detail, for one of the grid: every level has about a quarter of
/// those of the one before.
double levelShare(const LevelRange& levels);

/// Nodes that hold the mesh's box: never more than these.
TreeEstimate estimateByBox(const SnappedMesh& mesh);
/// Nodes that a boundary passes through.
TreeEstimate estimateByBoundary(const SnappedMesh& mesh, const Boundary& boundary);
/// Nodes with owners: those that the tets' faces pass through, and no more than those that they
/// fill.
TreeEstimate estimateByTets(const SnappedMesh& mesh);
/// Nodes of values that vary within tets: all that the tets fill.
TreeEstimate estimateByVolume(const SnappedMesh& mesh);

/// Throws Error(Limit) where `bytes` are more than options.maxMemory or the machine allow.
void requireMemory(double bytes, const VoxelizeOptions& options);

} // namespace tetvdb
