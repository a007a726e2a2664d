// SPDX-License-Identifier: Apache-2.0
//
// By which road triangles become a solid.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstdint>
#include <string>

namespace tetvdb {

struct VoxelizeJob;

enum class Mesher : std::uint8_t {
  Auto,     ///< as chooseMesher() says
  Envelope, ///< tets within epsilon (tetrahedralize/Tetrahedralize.h)
  Winding,  ///< voxels at once, by SolidOptions::inside (voxelize/VoxelizeTriangles.h)
  Centroid  ///< voxels at once, by SolidMethod::Centroid
};

/// "auto", "envelope", "winding" or "centroid".
std::string nameOf(Mesher mesher);

struct MesherChoice {
  Mesher road = Mesher::Winding; ///< not Auto
  std::string why;               ///< one clause, without a full stop
  double epsilon = 0;            ///< of the envelope, world units; 0 for other roads
};

/// Throws Error(Usage) where what the job asks for excludes each other: tets of a road that makes
/// none, a shell of tets.
void checkMesher(const VoxelizeJob& job);

/// The road for a job that checkMesher() has passed. Unless the job says: the envelope mesher where
/// tets are asked for (the grids tet_id and material, a mesh output of tets, an epsilon); the
/// winding number for shells and for other rules than InsideRule::Winding; else the envelope mesher
/// while its epsilon, half a voxel, is at least 1e-3 of the diagonal, and for finer grids the
/// winding number, which is faster there.
MesherChoice chooseMesher(const VoxelizeJob& job, double diagonal, const Vec3d& voxelSize);

/// Whether grids or mesh output need tets, so that no other road will do.
bool needsTets(const VoxelizeJob& job);

} // namespace tetvdb
