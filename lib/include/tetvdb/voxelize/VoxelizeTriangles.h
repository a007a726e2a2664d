// SPDX-License-Identifier: Apache-2.0
//
// Triangles into sparse grids: a voxel is inside where the winding number of the soup at its centre
// (perturbed as in geometry/Ownership.h) says so.
//
//   tetvdb::TriangleMesh mesh = tetvdb::readTriangles("broken.stl", report, progress);
//   tetvdb::cleanTriangles(mesh, {}, progress);
//   tetvdb::Voxelization result = tetvdb::voxelize(mesh, {}, {}, report, progress);
#pragma once

#include "tetvdb/geometry/FillRule.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <optional>

namespace tetvdb {

/// What makes a voxel centre inside.
enum class InsideRule : std::uint8_t {
  Winding, ///< winding number above 0.5
  NonZero, ///< winding number above 0.5 or below -0.5: whatever way the faces look
  Parity,  ///< an odd number of faces between the centre and infinity: every edge must have an even
           ///< number of faces
  Flood    ///< not reachable from outside along lines between neighbouring centres that no face
           ///< crosses: cavities are filled, and holes of a voxel or more leak
};

/// Where a shell lies.
enum class ShellSide : std::uint8_t {
  Both,    ///< half of its thickness on either side of the faces
  Outward, ///< all of it outside: of meshes that close, of the solid; of open ones on the side to
           ///< which the nearest face looks (voxelize/ShellSide.h)
  Inward   ///< all of it on the other side
};

struct SolidOptions {
  InsideRule inside = InsideRule::Winding;
  /// World units; above 0: no solid but a shell of this thickness, every voxel whose centre is
  /// within half of it of a face, or by `side` within all of it.
  double shell = 0;
  ShellSide side = ShellSide::Both; ///< others not with InsideRule::Flood

  /// Whether the winding number closes holes.
  bool closesHoles() const {
    return shell == 0 && (inside == InsideRule::Winding || inside == InsideRule::NonZero);
  }
};

/// Which winding numbers are inside; none for shells and InsideRule::Flood, which do not ask.
std::optional<FillRule> fillRuleOf(const SolidOptions& solid);

/// The box of the faces, larger by what a shell reaches beyond them (inward ones of open meshes
/// too).
WorldBox boxOf(const TriangleMesh& mesh, const SolidOptions& solid);

/// Voxel size and origin that voxelize() would use, as chooseTransform() for tets.
GridTransform chooseTransform(const TriangleMesh& mesh, const VoxelizeOptions& options,
                              const SolidOptions& solid = {});

/// The same for a box that boxOf() has given.
GridTransform chooseTransform(const WorldBox& box, const VoxelizeOptions& options,
                              const SolidOptions& solid);

/// Voxelizes a soup, cleaned or not (faces of equal points are summed up by their points' indices:
/// weld first). Grids: density and mask. A closed soup is decided by exact signed crossings. An
/// open one too, plus the solid angles of triangles over its holes, which are summed only near
/// where the winding number passes 0.5 off the faces (docs/algorithms.md). These sums are not
/// exact: no error above 4e-4 was measured, and 1e-3 (kWindingBandError) is allowed for, but no
/// bound is proved. Voxels of an open soup whose winding number is nearer to 0.5 than the error may
/// come out on the other side. By VoxelRule::Any a
/// voxel whose cube a face passes through is inside, and by All it is not, whatever the winding
/// number; where a hole is closed off the faces, centres decide. The result depends on
/// the faces as a set: not on their order, on the order of points or on threads. Throws as
/// voxelize() for tets does, and Error(Invalid) for soups without an inside, with the reason;
/// Error(Usage) for grids that need tets.
Voxelization voxelize(const TriangleMesh& mesh, const SolidOptions& solid,
                      const VoxelizeOptions& options, Report& report, Progress& progress);

} // namespace tetvdb
