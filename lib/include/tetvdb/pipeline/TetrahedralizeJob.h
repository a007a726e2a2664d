// SPDX-License-Identifier: Apache-2.0
//
// Converts files of triangles to a file of tetrahedra: the job of `tetvdb tetrahedralize`.
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
  TetrahedralizeOptions mesher; ///< the job's values replace its lengths and its maxMemory
  std::string output;           ///< .msh, .mesh or .vtu; empty, with `keep`: none
  bool keep = false;            ///< returns the tets, also if they are not written
  std::string preview;          ///< .png of the input and the tets (Preview.h); empty: none
  int threads = 0;              ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0;    ///< bytes for the whole process; 0: the available memory
};

struct TetrahedralizeResult {
  std::vector<InputInfo> inputs;
  std::vector<CleanCounts> cleaned;       ///< of each input
  std::vector<std::size_t> cleanedFaces;  ///< of each input, after cleaning
  std::vector<std::size_t> repairedFaces; ///< of each input: replaced or removed by repair
  MeshSummary mesh;
  std::map<std::int32_t, std::string> regionNames; ///< as written
  OutputInfo output;                               ///< empty if nothing was to be written
  std::optional<PreviewInfo> preview;
  std::optional<TetMesh> kept; ///< if TetrahedralizeJob::keep is set
};

/// Reads, cleans each input separately, tetrahedralizes and writes. Region 1, 2, ... of the file
/// belongs to the first, second, ... input and is named by the file without folder and extension
/// ("_2" and so on is appended to repeated names); a Boolean is one region, named by the operation.
/// The outside (keepOutside) is region 0, which Gmsh's format also distinguishes from the others.
/// Inputs whose triangles cut one another into too many tets are repaired in place
/// (repairLocally()), and meshed if their solids do not change by that. Outputs are checked before
/// the work starts. Adds stages "read", "clean", "tetrahedralize" (and "repair") and
/// "write" to `report`. Inputs with tets and lengths in voxels are Error(Usage). Throws the errors
/// of its stages; nothing is written then.
TetrahedralizeResult run(const TetrahedralizeJob& job, Report& report, Progress& progress);

} // namespace tetvdb
