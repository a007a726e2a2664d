// SPDX-License-Identifier: Apache-2.0
//
// Writes one file in another format without voxelizing, cleaning or repairing it: the job of
// `tetvdb convert`.
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
#include "tetvdb/volume/LevelsOfDetail.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tetvdb {

struct ConvertJob {
  std::string input;              ///< a mesh file, of triangles or of tets, or a volume file
  bool isVolume = false;          ///< the input is a volume: isVolumeFile() (io/VolumeFile.h)
  int timeStep = -1;              ///< of a mesh file with several, counted from 0; -1: the last
  ArrayInput arrayInput;          ///< of an array file
  bool allowEmpty = false;        ///< arrays of the background alone become empty grids
  std::string output;             ///< its extension determines the format
  int tileSize = 0;               ///< of a volume: as VoxelizeJob::tileSize
  LevelRange levels;              ///< of a volume into a volume: as VoxelizeJob::levels
  std::vector<std::string> grids; ///< of a volume, in that order; empty: all; for a surface the
                                  ///< first that defines a solid
  ArrayOptions arrays;            ///< if the output is an array file
  double simplify = 0;            ///< for a volume's surface, as ExtractOptions::simplify
  int threads = 0;                ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0;      ///< bytes for the whole process; 0: the available memory
};

struct ConvertResult {
  SolidSource source = SolidSource::Triangles;
  InputInfo input;                                   ///< of meshes
  std::vector<GridInfo> grids;                       ///< written grids
  std::size_t vertices = 0, triangles = 0, tets = 0; ///< written elements
  std::size_t tileFiles = 0;                         ///< written into a folder
  std::vector<OutputInfo> outputs;
};

/// Converts triangle meshes into triangle formats with every face unchanged; tet meshes into tet
/// formats, with their arrays and regions, or their outer surface into triangle formats; volumes
/// into volumes, arrays (io/ArrayFile.h) or, by extractSurface(), triangles. Conversions that
/// require a method are refused with Error(Usage) that names the command: meshes into volumes,
/// triangles into tets. Volumes become volumes node by node, without their trees
/// (convertVolumeFile() in io/VolumeStream.h), unless a .vdb file has grids that only OpenVDB
/// reads; a .vdb file of 256 MB or more becomes tiles by one child of the root
/// node at a time. Adds stages "read" (of what is read whole), "extract" (of surfaces) and "write"
/// to `report`. Throws the errors of its stages, and Error(Limit) where a maxMemory is below what
/// parts take: 64 MB, and 8 MB a thread, besides what is in use, less for small files; no output is
/// changed then.
ConvertResult run(const ConvertJob& job, Report& report, Progress& progress);

} // namespace tetvdb
