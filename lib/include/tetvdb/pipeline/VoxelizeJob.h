// SPDX-License-Identifier: Apache-2.0
//
// Converts mesh files to a volume file: the job of `tetvdb voxelize`.
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
#include "tetvdb/pipeline/Shard.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/volume/LevelsOfDetail.h"
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

/// Whether grids become whole trees on their way into a .vdb or .nvdb file. The file is the same.
enum class Streaming : std::uint8_t {
  Auto,   ///< whichever is faster; never whole trees where they would not fit into memory
  Always, ///< never whole trees, where that is possible (docs/huge.md)
  Never
};

/// OpenVDB's type of the grid mask. A MaskGrid takes a third less of a file and half of the memory;
/// Blender and Houdini show BoolGrids alone.
enum class MaskType : std::uint8_t { Bool, Mask };

struct VoxelizeJob {
  /// Mesh files or meshes in `memory`, of tets or of triangles; several are combined in one volume.
  std::vector<std::string> inputs;
  MemoryInputs memory;
  ReadOptions read;
  CellFilter filter;  ///< of tets; in the inputs' own axes, before `up`
  CleanOptions clean; ///< of triangles
  SolidOptions solid; ///< of triangles, if no tets are made of them
  Mesher mesher = Mesher::Auto;
  RelativeLength epsilon; ///< of the envelope mesher; 0: half a voxel
  UpAxis up = UpAxis::Z;
  /// Grids of occupancy and owners come first in the volume, then those of distances and shares,
  /// each group in this order.
  std::vector<GridKind> grids{GridKind::Density};
  VoxelizeOptions voxelize; ///< in the output's axes; its grids and maxMemory are replaced
  ShapeOptions shapes;      ///< its grids, maxMemory and device are replaced
  FieldOptions fields;      ///< of tets: arrays that become grids, after all others
  Warp warp;                ///< of tets: moves the points first; in the inputs' own axes
  bool smooth = false;      ///< of tets: smoothCells(), so that arrays over cells vary within them
  std::string output;       ///< .vdb, .nvdb or an array file; empty: no volume is written
  /// 512, 1024, 2048 or 4096: `output` is a folder of .vdb files of cubes of so many voxels along a
  /// side (io/TileFiles.h); 0: it is a file.
  int tileSize = 0;
  LevelRange levels;   ///< coarser grids that come after all others (addLevels())
  bool keep = false;   ///< makes and returns a volume, also if it is not written
  ArrayOptions arrays; ///< if the output is an array file
  /// .msh, .mesh or .vtu for the tets, those of the mesher if the inputs are triangles; .stl, .obj,
  /// .ply, .off or .3mf for the cleaned triangles; empty: none.
  std::string meshOutput;
  /// .png with the input, the tets, the volume and a slice of it, side by side (Preview.h); empty:
  /// none.
  std::string preview;
  /// Ranges that replace those of the fields (resolveFields()); empty: their own.
  std::vector<ValueRange> fieldRanges;
  std::map<std::string, std::string> metadata; ///< additional metadata of the file
  std::string units;   ///< stored as metadata "units"; lengths do not change
  DeviceChoice device; ///< voxelizes tets and computes distances; replaces that of `shapes`
  Streaming streaming = Streaming::Auto;
  Shard shard; ///< the part of the grids to make; if not whole, it is streamed in any case
  unsigned plan =
      0; ///< above 0: makes and writes nothing but VoxelizeResult::plan of as many shards
  MaskType maskType = MaskType::Bool;
  bool half = false;         ///< stores float grids with 16 bits per value
  int threads = 0;           ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0; ///< bytes for the whole process; 0: the available memory

  bool makesVolume() const { return keep || !output.empty(); }
};

/// What a shard would have to do.
struct ShardPlan {
  std::size_t rootChildren = 0;              ///< children of the root node, 4096^3 voxels each
  std::size_t fullRootChildren = 0;          ///< those that are one tile
  double share = 0;                          ///< of all the work, about: 1 over all shards
  Vec3i boxMin{0, 0, 0}, boxMax{-1, -1, -1}; ///< of them, voxels, inclusive
};

struct VoxelizeResult {
  std::vector<InputInfo> inputs;
  bool holdsTriangles = false; ///< instead of tets
  std::size_t tets = 0;
  std::size_t triangles = 0;          ///< after cleaning
  double volume = 0;                  ///< of the tets, world units cubed
  CleanCounts cleaned;                ///< of triangles
  std::size_t openEdges = 0;          ///< of triangles: edges at which the faces are not closed
  std::optional<MesherChoice> mesher; ///< of triangles: the method that made the result, if any
  std::optional<MeshSummary> made;    ///< by the envelope mesher
  SnapCounts counts;
  ShapeSums shapes;
  GridTransform transform;
  DeviceUsed device;       ///< of the grids except fields; if there are only fields, of those
  DeviceUsed fieldsDevice; ///< of the fields
  std::vector<GridInfo> grids;
  std::size_t tileFiles = 0;   ///< written into a folder
  std::vector<ShardPlan> plan; ///< where VoxelizeJob::plan asks for it
  std::vector<OutputInfo> outputs;
  std::optional<PreviewInfo> preview;
  std::optional<Volume> kept; ///< if VoxelizeJob::keep is set
};

/// Reads, splits and filters (tets) or cleans (triangles), merges, voxelizes and writes. Triangles
/// are voxelized by the method that chooseMesher() returns. If the envelope mesher runs out of
/// time or memory, or finds nothing inside, and no tets are required, the winding number is used
/// instead, with the warning "fell-back" and, except in the last case, `partial` in the report.
/// Several inputs of triangles are merged before they are cleaned. For the grid "material", each
/// is cleaned separately and is a material, numbered from 1 in the order of the inputs
/// (voxelizeMaterials()); density and mask are then the union of their solids, and level set, fog
/// and coverage use the faces of all. Before the work starts, the extensions (Error(Usage)) and
/// folders (Error(Write)) of the outputs are checked, and the device. Adds stages "read", "clean"
/// (triangles), "tetrahedralize" (the envelope mesher), "voxelize" and "write" to `report`, and
/// with a GPU "upload" and "download"; "preview" if one is requested; "fields" if `shapes` has
/// grids, and "holes" for open triangles. What a GPU cannot do the CPU does, with the warning
/// "device-unused". Tets and triangles in one job are Error(Usage), and so are filters
/// of cells, `fields` and `warp` for triangles. Fields add stage "fields"; a grid whose values
/// renderers do not show gives the warning "hidden-values", and one that `half` cannot represent
/// is Error(Invalid). Throws the errors of its stages; no output file is changed then, unless the
/// mesh output was already complete. Memory: the mesh, the grids, and estimateMemory() while
/// voxelizing.
VoxelizeResult run(const VoxelizeJob& job, Report& report, Progress& progress);

} // namespace tetvdb
