// SPDX-License-Identifier: Apache-2.0
//
// One input of a job, a mesh file or a mesh in memory, and what it held.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TetStatistics.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/pipeline/MemoryInput.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tetvdb {

/// What one input file held.
struct InputInfo {
  std::string path;
  FileFormat format = FileFormat::Unknown;
  std::size_t vertices = 0;
  std::size_t tets = 0;      ///< after splitting and filtering
  std::size_t triangles = 0; ///< of files that hold triangles: these have no cells and no tets
  std::string units;         ///< where the file says so
  std::vector<double> times; ///< of all steps of a file that has several
  std::size_t step = 0;      ///< which of them was read, from 0
  /// Number of cells of every kind, as the file names it.
  std::map<std::string, std::size_t> cells;
  TetStatistics statistics; ///< of those tets
};

/// The axis that points up for the program that will open the volume.
enum class UpAxis : std::uint8_t {
  Z, ///< as in the input
  Y  ///< (x, y, z) of the input becomes (x, z, -y): z-up input for a y-up program
};

/// Points of the input into the axes of the output.
void turnUp(std::vector<Vec3d>& points, UpAxis up);

/// Whether an input, a file or a mesh in `memory`, holds triangles; false for tets, for what cannot
/// be told and for pipes. Throws Error(Invalid) for a file that cannot be opened.
bool holdsTriangles(const std::string& path, const MemoryInputs& memory = {});

/// Reads one mesh file, or a mesh in `memory`, into tets. `info` may be null. Warnings and errors
/// name the input.
TetMesh readTets(const std::string& path, const ReadOptions& options, const CellFilter& filter,
                 InputInfo* info, Report& report, Progress& progress,
                 const MemoryInputs& memory = {});

/// Reads one file of triangles, or a mesh in `memory`, as it stands. `info` may be null. Warnings
/// and errors name the input.
TriangleMesh readSoup(const std::string& path, InputInfo* info, Report& report, Progress& progress,
                      const MemoryInputs& memory = {});

/// Warns ("unread-grid") of each grid of the file `path` that the reader does not understand.
void warnOfUnread(const Volume& volume, const std::string& path, Report& report);

/// Reads a volume file with warnOfUnread(), or hands out a volume in `memory`. Throws as
/// readVolume().
Volume readVolumeInput(const std::string& path, Report& report, Progress& progress,
                       const MemoryInputs& memory = {});

/// Those of `inputs` that are files.
std::vector<std::string> filesAmong(const std::vector<std::string>& inputs,
                                    const MemoryInputs& memory);

} // namespace tetvdb
