// SPDX-License-Identifier: Apache-2.0
//
// Exact distances to a closed surface from voxels on one side of it, stored only close to the
// requested distances.
//
//   const tetvdb::SolidDistances field(mesh, transform, 0, report, progress);
//   auto squared = field.between(tetvdb::SolidSide::Inside, 1.9, 2.1, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/TriangleScene.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>

namespace tetvdb {

enum class SolidSide : std::uint8_t { Inside, Outside };

/// The voxels of a solid and the distances to its surface. Refers to the mesh.
class SolidDistances {
public:
  /// `mesh` must be closed, oriented, without self-intersections, and have a face. Voxels of
  /// `transform` must be cubes. `maxMemory`, bytes, for the inside voxels; 0: the available memory.
  /// Adds stage "voxelize" to `report`. Throws as voxelize() for triangles does; a solid without
  /// voxel centres inside is empty.
  SolidDistances(const TriangleMesh& mesh, const GridTransform& transform, std::size_t maxMemory,
                 Report& report, Progress& progress);

  /// Squared distances to the surface, in voxels, of the voxels on that side; 0 on the other. If
  /// the distance is from `low` to `high`, world units, the value is that of the nearest point of
  /// the mesh (TriangleScene.h), rounded to a float; otherwise it is a lower bound on the same side
  /// of the range. Leaves where some voxel's distance may be in the range, tiles or the background
  /// elsewhere. Time and memory are proportional to the area at which distances are in the range:
  /// three or four searches of 1 to 3 us, and 70 bytes, per square voxel.
  openvdb::FloatGrid::Ptr between(SolidSide side, double low, double high,
                                  Progress& progress) const;

  const GridTransform& transform() const { return transform_; }
  const TriangleScene& scene() const { return scene_; } ///< of the mesh

private:
  const TriangleMesh& mesh_;
  TriangleScene scene_;
  GridTransform transform_;
  openvdb::BoolGrid::Ptr inside_;
};

/// Voxels of that size for a solid: the sides of its box, and planes at whole voxels from them,
/// pass between their centres. Throws as chooseTransform() does.
GridTransform offsetTransform(const TriangleMesh& mesh, double voxel);

/// Throws Error(Limit), with a sufficient voxel size, if a surface of the mesh's area in voxels of
/// that size, with `bytesPerSquare` bytes per square voxel, needs more than `maxMemory` bytes; 0:
/// the available memory.
void requireMemory(const TriangleMesh& mesh, double voxel, double bytesPerSquare,
                   std::size_t maxMemory);

} // namespace tetvdb
