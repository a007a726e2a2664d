// SPDX-License-Identifier: Apache-2.0
//
// One file into another format, with nothing voxelized, cleaned or repaired on the way: what
// `tetvdb convert` runs.
//
//   tetvdb::ConvertJob job;
//   job.input = "smoke.vdb";
//   job.output = "smoke.npz";
//   tetvdb::ConvertResult result = tetvdb::run(job, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/pipeline/RepairJob.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tetvdb {

struct ConvertJob {
  std::string input;              ///< a mesh file, of triangles or of tets, or a volume file
  bool isVolume = false;          ///< the input is a .vdb or .nvdb file
  std::string output;             ///< its extension says which format
  std::vector<std::string> grids; ///< of a volume, in that order; empty: all, of the surface the
                                  ///< first that can be a solid
  ArrayOptions arrays;            ///< of an output that is an array file
  double simplify = 0;            ///< of a volume's surface, as ExtractOptions::simplify
  int threads = 0;                ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0; ///< bytes for the whole process; 0: what the machine has available
};

struct ConvertResult {
  SolidSource source = SolidSource::Triangles;
  InputInfo input;                                   ///< of meshes
  std::vector<GridInfo> grids;                       ///< written
  std::size_t vertices = 0, triangles = 0, tets = 0; ///< written
  std::vector<OutputInfo> outputs;
};

/// Meshes of triangles into formats of triangles, every face as it stands; meshes of tets into
/// formats of tets, with their arrays and regions, or their outer surface into formats of
/// triangles. Volumes into volumes, into arrays (io/ArrayFile.h) or, by extractSurface(),
/// into triangles. What must be decided by a method is refused with Error(Usage) that names the
/// command: meshes into volumes, triangles into tets. Adds stages "read", "extract" (of surfaces)
/// and "write" to `report`. Throws what the steps throw; no output is touched then.
ConvertResult run(const ConvertJob& job, Report& report, Progress& progress);

} // namespace tetvdb
