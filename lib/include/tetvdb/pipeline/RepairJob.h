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
#include "tetvdb/pipeline/FinishSurface.h"
#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/pipeline/PreviewInfo.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/surface/CompareMeshes.h"
#include "tetvdb/surface/LocalRepair.h"
#include "tetvdb/surface/MeshChanges.h"
#include "tetvdb/surface/SurfaceDefects.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

/// What a file holds that a surface can be made of.
enum class SolidSource : std::uint8_t { Triangles, Tets, Volume };

/// "triangles", "tets" or "volume".
const char* nameOf(SolidSource source);

struct RepairJob {
  std::string input; ///< a mesh, of triangles or of tets, or a volume: a file or in `memory`
  /// Further inputs of triangles, as `input` is then.
  std::vector<std::string> more;
  MemoryInputs memory;
  bool isVolume = false;    ///< the input is a .vdb or .nvdb file, or a volume
  std::string grid;         ///< of a volume, as ExtractOptions::grid
  std::string output;       ///< .stl, .obj, .ply, .off or .3mf; empty, with `keep` alone: none
  bool keep = false;        ///< the surface is handed out, written or not
  std::string preview;      ///< .png of before and after (Preview.h); empty: none
  CleanOptions clean;       ///< of triangles
  SolidOptions solid;       ///< of meshes
  Vec3d voxelSize{0, 0, 0}; ///< of meshes, as VoxelizeOptions::voxelSize
  int resolution = 0;       ///< of meshes, as VoxelizeOptions::resolution; 0: by voxelForDetail()
  double simplify = 0.1;    ///< as ExtractOptions::simplify
  bool remesh = false;      ///< also what is in order already
  FinishOptions finish;     ///< of the surface, once it is in order; faces of all objects together
  double scale = 1;         ///< coordinates are multiplied by it in the end
  /// Of the output, as metresOf() knows it: coordinates of an input in other units are converted.
  /// Empty: as the input has it.
  std::string units;
  int threads = 0;           ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0; ///< bytes for the whole process; 0: what the machine has available
};

struct RepairResult {
  std::string name; ///< of the object, where it has one
  /// Of several objects, where the output keeps them apart: each one's, with the sums and the
  /// largest distances in the other members; `before` and what follows from it are of each alone.
  std::vector<RepairResult> objects;
  std::string units; ///< of the output, where they are known
  SolidSource source = SolidSource::Triangles;
  InputInfo input;                         ///< of meshes
  CleanCounts cleaned;                     ///< of meshes
  std::optional<SurfaceDefects> before;    ///< of meshes, as they were read
  std::optional<LocalRepair> local;        ///< of meshes that were not in order once cleaned
  std::string why;                         ///< of remeshing, where it was not asked for
  bool remeshed = true;                    ///< false: faces that were in order are as they were
  std::optional<MeshChanges> changes;      ///< of meshes: from the input to the output
  std::optional<MeshDistance> distance;    ///< of the input (a) and the output, if faces changed
  GridTransform transform;                 ///< of the grid in between
  std::size_t extracted = 0;               ///< faces before simplification; 0 where not remeshed
  std::optional<FinishResult> finished;    ///< where it was asked for
  std::size_t vertices = 0, triangles = 0; ///< written
  double volumeBefore = 0;                 ///< of meshes, cleaned; world units cubed
  double volumeAfter = 0;
  OutputInfo output; ///< empty where nothing was to be written
  std::optional<PreviewInfo> preview;
  std::optional<TriangleMesh> kept; ///< where RepairJob::keep asks for it, of all objects
};

/// Reads and cleans. Objects of a .3mf file, and those of several files, are repaired each by
/// itself and keep their names and their places together where the output is .3mf; other formats
/// have no objects: there all become one mesh first, with the warning "objects-joined". A mesh that
/// is then closed, manifold, oriented and without self-intersections is written as it is, unless
/// `remesh` asks otherwise; one that is not is repaired where it is not (LocalRepair.h), everything
/// else staying bit for bit. Where that cannot make such a mesh of the same solid, with a shell,
/// and with `remesh`, the mesh is voxelized by its winding number (VoxelizeTriangles.h), and the
/// surface of the voxels inside (ExtractSurface.h), drawn onto the mesh where it is near, is
/// written, with the warning "remeshed" unless that was asked for: closed, manifold and oriented.
/// Where the solid's volume changes by more than 1 % by that, or by more than 0.1 % by repair in
/// place, the warning "volume-changed" says so; the report is partial in the former case. Tets are
/// their surface; a volume's surface is extracted at once. Then finishSurface() smooths and
/// simplifies it, if that is asked for. Adds stages "read", "clean", "check", "repair", "voxelize",
/// "extract", those of finishSurface() and "write" to `report`. Throws what the steps throw; sheets
/// without an inside are Error(Invalid). Where the output is .3mf, which has units, and the input's
/// are unknown, the warning "unit-guessed" says that millimetres are written.
RepairResult run(const RepairJob& job, Report& report, Progress& progress);

} // namespace tetvdb
