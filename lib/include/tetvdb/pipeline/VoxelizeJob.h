// SPDX-License-Identifier: Apache-2.0
//
// One job from mesh files to a volume file: what `tetvdb voxelize` runs.
//
//   tetvdb::VoxelizeJob job;
//   job.inputs = {"bracket.vtu"};
//   job.output = "bracket.vdb";
//   job.voxelize.resolution = 512;
//   tetvdb::Report report;
//   tetvdb::Progress progress;
//   tetvdb::VoxelizeResult result = tetvdb::run(job, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/fields/Field.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/fields/Warp.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/pipeline/MeshSummary.h"
#include "tetvdb/pipeline/Mesher.h"
#include "tetvdb/pipeline/PreviewInfo.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/pipeline/RelativeLength.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/DeviceChoice.h"
#include "tetvdb/voxelize/Voxelize.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

struct VoxelizeJob {
  /// Mesh files or meshes in `memory`, of tets or of triangles; several become one volume.
  std::vector<std::string> inputs;
  MemoryInputs memory;
  ReadOptions read;
  CellFilter filter;  ///< of tets; in the inputs' own axes, before `up`
  CleanOptions clean; ///< of triangles
  SolidOptions solid; ///< of triangles, where no tets are made of them
  Mesher mesher = Mesher::Auto;
  RelativeLength epsilon; ///< of the envelope mesher; 0: half a voxel
  UpAxis up = UpAxis::Z;
  /// Grids of occupancy and owners come first in the volume, then those of distances and shares,
  /// each in this order.
  std::vector<GridKind> grids{GridKind::Density};
  VoxelizeOptions voxelize; ///< in the output's axes; its grids and maxMemory are the job's
  ShapeOptions shapes;      ///< its grids, maxMemory and device are the job's
  FieldOptions fields;      ///< of tets: arrays that become grids, after all others
  Warp warp;                ///< of tets: moves the points first; in the inputs' own axes
  std::string output;       ///< .vdb, .nvdb or an array file; empty: no volume is written
  bool keep = false;        ///< a volume is made and handed out, written or not
  ArrayOptions arrays;      ///< of an output that is an array file
  /// .msh, .mesh or .vtu that receives the tets, the mesher's where the inputs are triangles; .stl,
  /// .obj, .ply, .off or .3mf for the cleaned triangles; empty: none.
  std::string meshOutput;
  /// .png that shows the input, the tets, the volume and a slice of it, side by side (Preview.h);
  /// empty: none.
  std::string preview;
  /// Ranges of the fields in place of their own (resolveFields()); empty: their own.
  std::vector<ValueRange> fieldRanges;
  std::map<std::string, std::string> metadata; ///< more of it for the file
  std::string units;         ///< stored as metadata "units"; no lengths are changed
  DeviceChoice device;       ///< where tets are voxelized and distances found; not that of `shapes`
  bool half = false;         ///< float grids are stored with 16 bits a value
  int threads = 0;           ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0; ///< bytes for the whole process; 0: what the machine has available

  bool makesVolume() const { return keep || !output.empty(); }
};

struct VoxelizeResult {
  std::vector<InputInfo> inputs;
  bool holdsTriangles = false; ///< rather than tets
  std::size_t tets = 0;
  std::size_t triangles = 0;          ///< after cleaning
  double volume = 0;                  ///< of the tets, world units cubed
  CleanCounts cleaned;                ///< of triangles
  std::size_t openEdges = 0;          ///< of triangles: edges at which the faces do not close
  std::optional<MesherChoice> mesher; ///< of triangles: the method taken in the end, if any was
  std::optional<MeshSummary> made;    ///< by the envelope mesher
  SnapCounts counts;
  ShapeSums shapes;
  GridTransform transform;
  DeviceUsed device;       ///< of the grids that are no fields; where there are none, of those
  DeviceUsed fieldsDevice; ///< of the fields
  std::vector<GridInfo> grids;
  std::vector<OutputInfo> outputs;
  std::optional<PreviewInfo> preview;
  std::optional<Volume> kept; ///< where VoxelizeJob::keep asks for it
};

/// Reads, splits and filters (tets) or cleans (triangles), merges, voxelizes and writes. Triangles
/// become voxels by the method that chooseMesher() says; where the envelope mesher runs out of time
/// or memory, or finds nothing inside, and no tets are needed, the winding number takes over, with
/// a warning
/// ("fell-back") and, but for the last, `partial` in the report. Several inputs of triangles are
/// merged before they are cleaned. For the grid "material" each is cleaned for itself and is a
/// material of its own, the first input's number being 1 (voxelizeMaterials()); then density and
/// mask are the union of their solids, and level set, fog and coverage have the faces of them all.
/// Outputs are checked before any work: their extensions (Error(Usage)) and folders (Error(Write)),
/// and so is the device. Adds stages "read", "clean" (triangles), "tetrahedralize" (the envelope
/// mesher), "voxelize" and "write" to `report`, and with a GPU "upload" and "download"; "preview"
/// where a preview is asked for; "fields" where `shapes` asks for grids. The winding number and
/// coverage are the CPU's: asking for a GPU is a warning
/// ("device-unused"). Tets and triangles in one job are Error(Usage), and so are filters of
/// cells for triangles, as are `fields` and `warp`. Fields add stage "fields"; a grid whose values
/// renderers would not show is a warning ("hidden-values"), and one that `half` cannot hold is
/// Error(Invalid). Throws what the steps throw; no output file is touched then, unless the mesh
/// output was already whole. Memory: the mesh, the grids, and estimateMemory() while voxelizing.
VoxelizeResult run(const VoxelizeJob& job, Report& report, Progress& progress);

} // namespace tetvdb
