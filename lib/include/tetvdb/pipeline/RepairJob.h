// SPDX-License-Identifier: Apache-2.0
//
// Converts any mesh, or a volume, to a closed manifold surface: the job of `tetvdb repair`.
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
#include "tetvdb/surface/RoundToFloats.h"
#include "tetvdb/surface/SurfaceDefects.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

/// The kinds of content from which a surface is made.
enum class SolidSource : std::uint8_t { Triangles, Tets, Volume };

/// "triangles", "tets" or "volume".
const char* nameOf(SolidSource source);

struct RepairJob {
  std::string input; ///< a mesh, of triangles or of tets, or a volume: a file or in `memory`
  /// Further inputs of triangles; `input` must then be triangles too.
  std::vector<std::string> more;
  MemoryInputs memory;
  bool isVolume = false;    ///< the input is a .vdb or .nvdb file, or a volume
  std::string grid;         ///< of a volume, as ExtractOptions::grid
  std::string output;       ///< .stl, .obj, .ply, .off or .3mf; empty, with `keep`: none
  bool keep = false;        ///< returns the surface, also if it is not written
  std::string preview;      ///< .png of before and after (Preview.h); empty: none
  CleanOptions clean;       ///< of triangles
  SolidOptions solid;       ///< of meshes
  Vec3d voxelSize{0, 0, 0}; ///< of meshes, as VoxelizeOptions::voxelSize
  int resolution = 0;       ///< of meshes, as VoxelizeOptions::resolution; 0: by voxelForDetail()
  double simplify = 0.1;    ///< as ExtractOptions::simplify
  bool remesh = false;      ///< remeshes also if there are no defects
  FinishOptions finish;     ///< of the repaired surface; faces of all objects together
  double scale = 1;         ///< finally multiplies the coordinates
  /// Of the output, as for metresOf(): coordinates of an input in other units are converted. Empty:
  /// as in the input.
  std::string units;
  int threads = 0;           ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0; ///< bytes for the whole process; 0: the available memory
};

struct RepairResult {
  std::string name; ///< of the object, if it has one
  /// For several objects, if the output keeps them separate: the result of each; the other members
  /// have the sums and the largest distances; `before` and the following are per object.
  std::vector<RepairResult> objects;
  std::string units; ///< of the output, if known
  SolidSource source = SolidSource::Triangles;
  InputInfo input;                         ///< of meshes
  CleanCounts cleaned;                     ///< of meshes
  std::optional<SurfaceDefects> before;    ///< of meshes, as read
  std::optional<LocalRepair> local;        ///< of meshes with defects after cleaning
  std::string why;                         ///< reason for remeshing, if not requested
  bool remeshed = true;                    ///< false: faces without defects are unchanged
  std::optional<MeshChanges> changes;      ///< of meshes: from the input to the output
  std::optional<MeshDistance> distance;    ///< of the input (a) and the output, if faces changed
  GridTransform transform;                 ///< of the intermediate grid
  std::size_t extracted = 0;               ///< faces before simplification; 0 if not remeshed
  std::optional<FinishResult> finished;    ///< if requested
  std::optional<FloatRounding> rounded;    ///< if the output's format has floats
  std::size_t vertices = 0, triangles = 0; ///< written
  double volumeBefore = 0;                 ///< of meshes, cleaned; world units cubed
  double volumeAfter = 0;
  OutputInfo output; ///< empty if nothing was to be written
  std::optional<PreviewInfo> preview;
  std::optional<TriangleMesh> kept; ///< if RepairJob::keep is set, of all objects
};

/// Reads and cleans. Objects of a .3mf file, and those of several files, are repaired separately
/// and keep their names and relative positions if the output is .3mf. Other formats have no
/// objects: all are merged into one mesh first, with the warning "objects-joined". A mesh that is
/// then closed, manifold, oriented and without self-intersections is written unchanged, unless
/// `remesh` is set; otherwise it is repaired at its defects (LocalRepair.h), and all other faces
/// stay bit for bit. If that fails to produce such a mesh of the same solid, with a shell, and with
/// `remesh`, the mesh is voxelized by its winding number (VoxelizeTriangles.h), and the surface of
/// the inside voxels (ExtractSurface.h), with vertices moved onto the mesh where it is close, is
/// written, with the warning "remeshed" unless it was requested: closed, manifold and oriented. If
/// this changes the solid's volume by more than 1 %, or repair in place changes it by more than 0.1
/// %, the warning "volume-changed" is added; above 1 % the report is partial. Tets are
/// replaced by their surface; a volume's surface is extracted directly. Then finishSurface()
/// smooths and simplifies it, if requested, and for .stl and .3mf it is rounded to 32-bit floats
/// (RoundToFloats.h); if faces still cross by that, the report is partial, with the warning
/// "float-crossings". Adds stages "read", "clean", "check", "repair", "voxelize", "extract", those
/// of finishSurface(), "round" and "write" to `report`. Throws the errors of
/// its stages; sheets without an inside are Error(Invalid). If the output is .3mf, which requires a
/// unit, and that of the input is unknown, millimetres are written with the warning "unit-guessed".
RepairResult run(const RepairJob& job, Report& report, Progress& progress);

struct MendedSolid {
  std::string broken;  ///< what the mesh had, as whatIsBroken(); empty: it is as it was
  bool remade = false; ///< its surface was remade from voxels
};

/// Mends a cleaned mesh as run() does, with its stages and warnings. `name`: of the mesh, for
/// errors and warnings. `maxMemory`: as RepairJob::maxMemory. Throws the errors of run().
MendedSolid mendSolid(TriangleMesh& mesh, const std::string& name, std::size_t maxMemory,
                      Report& report, Progress& progress);

} // namespace tetvdb
