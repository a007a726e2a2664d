// SPDX-License-Identifier: Apache-2.0
//
// Tetrahedra into sparse grids. A voxel centre belongs to a tet by the ownership rule of
// geometry/Ownership.h: exactly one of the tets that meet in a face, an edge or a vertex gets it.
//
//   tetvdb::VoxelizeOptions options;
//   options.voxelSize = {0.01, 0.01, 0.01};
//   options.grids = {tetvdb::GridKind::Density};
//   tetvdb::Voxelization result = tetvdb::voxelize(mesh, options, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/volume/GridKinds.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// How occupancy is found; the result is the same.
enum class OccupancyPath : std::uint8_t {
  Auto,     ///< whichever a cost estimate finds faster
  Boundary, ///< signed crossings of the boundary faces
  Tets      ///< every tet rasterised
};

/// Which voxels are inside. The cube of a voxel reaches half a voxel to each side of its centre.
enum class VoxelRule : std::uint8_t {
  Centre, ///< those whose centre is, each tet's by geometry/Ownership.h
  Any,    ///< those whose cube the solid meets, be it in the smallest volume
  All     ///< those whose cube lies in the solid; of cubes that a face within a solid crosses, as
          ///< where tets overlap, that is not known, and they are left out
};

/// A cube of voxels, numbered from (0, 0, 0), in whose middle the box of the mesh is placed, so
/// large that its longest side takes all voxels but the padding.
struct FitBox {
  int voxels = 0;  ///< along each axis; 0: no such cube
  int padding = 0; ///< voxels on each side that are left free
};

struct VoxelizeOptions {
  Vec3d voxelSize{0, 0, 0}; ///< world units, one an axis; all zero: from `fit` or `resolution`
  int resolution = 256;     ///< most voxels along any side of the mesh's box; where voxelSize is 0
  Vec3d origin{0, 0, 0};    ///< world units: the centre of voxel (0, 0, 0)
  FitBox fit;               ///< in place of `resolution` and `origin`; where voxelSize is 0
  std::vector<GridKind> grids{GridKind::Density}; ///< made by GridMaker::Occupancy or Owner
  OccupancyPath path = OccupancyPath::Auto;
  VoxelRule rule =
      VoxelRule::Centre;     ///< others: density and mask alone, by OccupancyPath::Boundary
  std::size_t maxMemory = 0; ///< bytes for this stage; 0: what the machine has available
  bool allowEmpty = false;   ///< false: a result without active voxels is Error(Invalid)
};

/// What snapping and looking at the mesh found.
struct SnapCounts {
  std::uint64_t flipped = 0;       ///< tets reversed, their volume was negative
  std::uint64_t dropped = 0;       ///< tets without volume after snapping
  std::uint64_t boundaryFaces = 0; ///< 0 where the boundary was not needed
  std::uint64_t openEdges = 0;     ///< of triangles: edges at which the faces do not close
};

struct Voxelization {
  Volume volume;           ///< one grid for each of options.grids, in that order
  GridTransform transform; ///< as used: size from `resolution`, origin moved if it had to be
  SnapCounts counts;
  OccupancyPath path = OccupancyPath::Tets; ///< the one taken
  std::size_t estimatedBytes = 0; ///< memory the stage was expected to take, above the mesh itself
};

/// Voxel size and origin that voxelize() would use for a mesh. Throws as voxelize() does for sizes
/// that are not positive, below OpenVDB's limit (volume 3e-15), or that leave 32-bit index space.
GridTransform chooseTransform(const TetMesh& mesh, const VoxelizeOptions& options);

/// Voxelizes. The grids depend on mesh and options alone: any thread count, order of tets (but for
/// the numbers in tet_id) and path gives the same. Adds stage "voxelize" to `report`.
/// Memory is estimated first (from the boundary's area, or the tets' volumes where owners are asked
/// for) and refused with Error(Limit) when it does not fit; nothing of the grids exists then.
/// Throws Error(Usage) for bad options, Error(Invalid) for an empty result or coordinates that are
/// not finite, Error(Limit) for memory or for a tet longer than 2^20 voxels, Error(Cancelled).
/// Uses the calling thread's TBB arena.
Voxelization voxelize(const TetMesh& mesh, const VoxelizeOptions& options, Report& report,
                      Progress& progress);

} // namespace tetvdb
