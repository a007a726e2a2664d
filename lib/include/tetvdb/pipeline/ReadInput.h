// SPDX-License-Identifier: Apache-2.0
//
// Reads one input of a job, a mesh file or a mesh in memory, and describes it.
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

/// The contents of one input file.
struct InputInfo {
  std::string path;
  FileFormat format = FileFormat::Unknown;
  std::size_t vertices = 0;
  std::size_t tets = 0;      ///< after splitting and filtering
  std::size_t triangles = 0; ///< of triangle files, which have no cells and no tets
  std::string units;         ///< if given in the file
  std::vector<double> times; ///< of all steps of a file with several
  std::size_t step = 0;      ///< the step that was read, from 0
  /// Number of cells of every type, by the name in the file.
  std::map<std::string, std::size_t> cells;
  TetStatistics statistics; ///< of those tets
};

/// The up axis of the program that will open the volume.
enum class UpAxis : std::uint8_t {
  Z, ///< as in the input
  Y  ///< (x, y, z) of the input becomes (x, z, -y): z-up input for a y-up program
};

/// Converts points from the input's axes to the output's.
void turnUp(std::vector<Vec3d>& points, UpAxis up);

/// Whether an input, a file or a mesh in `memory`, contains triangles; false for tets, for pipes
/// and if it cannot be determined. Throws Error(Invalid) for a file that cannot be opened.
bool holdsTriangles(const std::string& path, const MemoryInputs& memory = {});

/// Reads one mesh file, or a mesh in `memory`, into tets. `info` may be null. Warnings and errors
/// name the input.
TetMesh readTets(const std::string& path, const ReadOptions& options, const CellFilter& filter,
                 InputInfo* info, Report& report, Progress& progress,
                 const MemoryInputs& memory = {});

/// Reads one file of triangles, or a mesh in `memory`, unchanged. `info` may be null. Warnings and
/// errors name the input.
TriangleMesh readSoup(const std::string& path, InputInfo* info, Report& report, Progress& progress,
                      const MemoryInputs& memory = {});

/// Warns ("not-numbers") of voxels that are NaN in arrays of the file `path`.
void warnOfNaN(const Volume& volume, const std::string& path, Report& report);

/// The same, and warns ("unread-grid") of each grid of the file that the reader does not
/// understand.
void warnOfReading(const Volume& volume, const std::string& path, Report& report);

/// Reads a volume file with warnOfReading(), or returns a volume in `memory`. Throws as
/// readVolume().
Volume readVolumeInput(const std::string& path, Report& report, Progress& progress,
                       const MemoryInputs& memory = {});

/// Those of `inputs` that are files.
std::vector<std::string> filesAmong(const std::vector<std::string>& inputs,
                                    const MemoryInputs& memory);

} // namespace tetvdb
