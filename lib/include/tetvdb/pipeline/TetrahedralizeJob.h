// SPDX-License-Identifier: Apache-2.0
//
// One job from files of triangles to a file of tetrahedra: what `tetvdb tetrahedralize` runs.
//
//   tetvdb::TetrahedralizeJob job;
//   job.inputs = {"housing.stl", "shaft.stl"};
//   job.output = "both.msh";
//   tetvdb::TetrahedralizeResult result = tetvdb::run(job, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/pipeline/MeshSummary.h"
#include "tetvdb/pipeline/PreviewInfo.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/pipeline/RelativeLength.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/tetrahedralize/Tetrahedralize.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

struct TetrahedralizeJob {
  /// Files of triangles, or triangles in `memory`, one material each.
  std::vector<std::string> inputs;
  MemoryInputs memory;
  CleanOptions clean;
  RelativeLength epsilon;       ///< 0: as TetrahedralizeOptions::epsilon; not in voxels
  RelativeLength edgeLength;    ///< 0: as TetrahedralizeOptions::edgeLength; not in voxels
  TetrahedralizeOptions mesher; ///< its lengths and its maxMemory are overruled by the job's
  std::string output;           ///< .msh, .mesh or .vtu; empty, with `keep` alone: none
  bool keep = false;            ///< the tets are handed out, written or not
  std::string preview;          ///< .png of the input and the tets (Preview.h); empty: none
  int threads = 0;              ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0;    ///< bytes for the whole process; 0: what the machine has available
};

struct TetrahedralizeResult {
  std::vector<InputInfo> inputs;
  std::vector<CleanCounts> cleaned;      ///< of each input
  std::vector<std::size_t> cleanedFaces; ///< of each input, that are left
  MeshSummary mesh;
  std::map<std::int32_t, std::string> regionNames; ///< as written
  OutputInfo output;                               ///< empty where nothing was to be written
  std::optional<PreviewInfo> preview;
  std::optional<TetMesh> kept; ///< where TetrahedralizeJob::keep asks for it
};

/// Reads, cleans every input for itself, tetrahedralizes and writes. Region 1, 2, ... of the file
/// is what the first, second, ... input owns, named by the file without folder and extension
/// ("_2" and so on added where that is taken); a Boolean is one region, named by what it is. What
/// is outside (keepOutside) is region 0, which Gmsh's format, too, can tell from the others.
/// Outputs are checked before any work. Adds stages "read", "clean", "tetrahedralize" and "write"
/// to `report`. Inputs that hold tets and lengths in voxels are Error(Usage). Throws what the steps
/// throw; nothing is written then.
TetrahedralizeResult run(const TetrahedralizeJob& job, Report& report, Progress& progress);

} // namespace tetvdb
