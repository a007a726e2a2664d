// SPDX-License-Identifier: Apache-2.0
//
// One job from files to pictures of them: what `tetvdb render` runs. Meshes in memory are drawn by
// PictureMaker.h.
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
  std::string output; ///< .png, of a turntable OUT.0001.png and so on; empty, with `keep`: none
  bool keep = false;  ///< the pictures are handed out, written or not
  MeshLook look;      ///< of meshes
  VolumeShow volume;  ///< of volumes; `look.color` is its colour too
  PictureOptions picture;
  std::size_t turntable = 0; ///< so many pictures of a full turn; 0: one picture
  int threads = 0;           ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0; ///< bytes for the whole process; 0: what the machine has available
};

struct RenderResult {
  std::vector<InputInfo> inputs;
  std::vector<Drawn> drawn; ///< counts alone: what was drawn is gone
  int width = 0, height = 0;
  std::optional<ColorScale> scale;
  std::vector<OutputInfo> outputs;
  std::vector<Image> kept; ///< where RenderJob::keep asks for them
};

/// The files that a picture or a turntable of so many pictures is written to: OUT.png, or
/// OUT.0001.png and so on.
std::vector<std::string> pictureNames(const std::string& output, std::size_t turntable);

/// Reads all files, draws them (several side by side at one scale, with their names), and writes
/// once all pictures are there. Adds stages "read", "scene", "render" and "write" to `report`.
/// Throws what the steps throw, with the file's name; Error(Usage) for what does not fit the
/// inputs.
RenderResult run(const RenderJob& job, Report& report, Progress& progress);

} // namespace tetvdb
