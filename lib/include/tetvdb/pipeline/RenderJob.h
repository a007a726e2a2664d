// SPDX-License-Identifier: Apache-2.0
//
// Draws pictures of files: the job of `tetvdb render`. PictureMaker.h draws meshes in
// memory.
//
//   tetvdb::RenderJob job;
//   job.inputs = {{"part.stl"}};
//   job.output = "part.png";
//   tetvdb::RenderResult result = tetvdb::run(job, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/visualize/Image.h"
#include "tetvdb/visualize/PictureMaker.h"
#include "tetvdb/visualize/VolumeSubject.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

struct RenderInput {
  std::string path;      ///< a mesh of triangles or of tets, or a volume; or its name in `memory`
  bool isVolume = false; ///< a .vdb or .nvdb file, or a volume
};

struct RenderJob {
  std::vector<RenderInput> inputs;
  MemoryInputs memory;
  std::string output; ///< .png, for a turntable OUT.0001.png and so on; empty, with `keep`: none
  bool keep = false;  ///< returns the pictures, also if they are not written
  MeshLook look;      ///< of meshes
  VolumeShow volume;  ///< of volumes; `look.color` is also their colour
  PictureOptions picture;
  std::size_t turntable = 0; ///< number of pictures of a full rotation; 0: one picture
  int threads = 0;           ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0; ///< bytes for the whole process; 0: the available memory
};

struct RenderResult {
  std::vector<InputInfo> inputs;
  std::vector<Drawn> drawn; ///< counts only: the drawn data is released
  int width = 0, height = 0;
  std::optional<ColorScale> scale;
  std::vector<OutputInfo> outputs;
  std::vector<Image> kept; ///< if RenderJob::keep is set
};

/// The files of a picture or of a turntable with this number of pictures: OUT.png, or OUT.0001.png
/// and so on.
std::vector<std::string> pictureNames(const std::string& output, std::size_t turntable);

/// Reads all files, draws them (several side by side at one scale, with their names), and writes
/// the pictures when all are complete. Adds stages "read", "scene", "render" and "write" to
/// `report`. Throws the errors of its stages, with the file's name; Error(Usage) for options that
/// do not apply to the inputs.
RenderResult run(const RenderJob& job, Report& report, Progress& progress);

} // namespace tetvdb
