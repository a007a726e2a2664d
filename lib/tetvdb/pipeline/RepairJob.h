// SPDX-License-Identifier: Apache-2.0
//
// One job from any mesh, or a volume, to a closed manifold surface: what `tetvdb repair` runs.
//
//   tetvdb::RepairJob job;
//   job.input = "broken.stl";
//   job.output = "whole.stl";
//   tetvdb::RepairResult result = tetvdb::run(job, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/pipeline/Preview.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/surface/SurfaceDefects.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace tetvdb {

/// What a file holds that a surface can be made of.
enum class SolidSource : std::uint8_t { Triangles, Tets, Volume };

struct RepairJob {
  std::string input;         ///< a mesh file, of triangles or of tets, or a volume file
  bool isVolume = false;     ///< the input is a .vdb or .nvdb file
  std::string grid;          ///< of a volume, as ExtractOptions::grid
  std::string output;        ///< .stl, .obj, .ply, .off or .3mf
  std::string preview;       ///< .png of before and after (Preview.h); empty: none
  CleanOptions clean;        ///< of triangles
  SolidOptions solid;        ///< of meshes
  Vec3d voxelSize{0, 0, 0};  ///< of meshes, as VoxelizeOptions::voxelSize
  int resolution = 256;      ///< of meshes, as VoxelizeOptions::resolution
  double simplify = 0.1;     ///< as ExtractOptions::simplify
  bool remesh = false;       ///< also what is in order already
  int threads = 0;           ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0; ///< bytes for the whole process; 0: what the machine has available
};

struct RepairResult {
  SolidSource source = SolidSource::Triangles;
  InputInfo input;                         ///< of meshes
  CleanCounts cleaned;                     ///< of meshes
  std::optional<SurfaceDefects> before;    ///< of meshes, as they were read
  bool remeshed = true;                    ///< false: the cleaned mesh was in order as it was
  GridTransform transform;                 ///< of the grid in between
  std::size_t extracted = 0;               ///< faces before simplification; 0 where not remeshed
  std::size_t vertices = 0, triangles = 0; ///< written
  double volumeBefore = 0;                 ///< of meshes, cleaned; world units cubed
  double volumeAfter = 0;
  OutputInfo output;
  std::optional<PreviewInfo> preview;
};

/// Reads and cleans. A mesh that is then closed, manifold, oriented and without self-intersections
/// is written as it is, unless `remesh` asks otherwise. Any other is voxelized by its winding
/// number (VoxelizeTriangles.h), and the surface of the voxels inside (ExtractSurface.h), drawn
/// onto the mesh where it is near, is written: closed, manifold and oriented. Tets are their
/// surface; a volume's surface is extracted at once. Adds stages "read", "clean", "voxelize",
/// "extract" and "write" to `report`. Throws what the steps throw; sheets without an inside are
/// Error(Invalid).
RepairResult run(const RepairJob& job, Report& report, Progress& progress);

} // namespace tetvdb
