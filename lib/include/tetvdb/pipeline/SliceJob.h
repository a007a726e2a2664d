// SPDX-License-Identifier: Apache-2.0
//
// One job from a mesh or a volume to a printer's layers: what `tetvdb slice` runs.
//
//   tetvdb::SliceJob job;
//   job.inputs = {"part.stl"};
//   job.output = "part.sl1";
//   job.printer = tetvdb::readPrinter("sl1s.ini");
//   tetvdb::SliceResult result = tetvdb::run(job, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/pipeline/RepairJob.h"
#include "tetvdb/print/GreyLevels.h"
#include "tetvdb/print/LayerFile.h"
#include "tetvdb/print/PlaceOptions.h"
#include "tetvdb/print/PrinterSettings.h"
#include "tetvdb/surface/CleanTriangles.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

/// What a pixel's level is.
enum class SliceAa : std::uint8_t {
  Volume, ///< the share of the voxel that is solid
  Area,   ///< the share of the pixel in the layer's middle plane
  None    ///< white where the voxel's centre is in the solid (voxelize/Ownership.h)
};

struct SliceJob {
  /// Meshes of triangles or of tets, or a volume, files or in `memory`; several, of triangles, are
  /// put together as they stand to each other.
  std::vector<std::string> inputs;
  MemoryInputs memory;
  bool isVolume = false;   ///< the input is a .vdb or .nvdb file, or a volume
  std::string grid;        ///< of a volume, by name; empty: the first that is a solid
  std::string output;      ///< a file, or a folder; empty, with `keep`: none
  bool keep = false;       ///< the layers are handed out in place of being written
  std::string format;      ///< as LayerFormat::name; empty: by the output's ending
  PrinterSettings printer; ///< checked by checkPrinter()
  PlaceOptions place;
  std::string units; ///< of the input, as metresOf(); empty: what the file says, else millimetres
  SliceAa aa = SliceAa::Volume;
  GreyOptions grey;
  bool dither = false;       ///< levels by error diffusion (print/ErrorDiffusion.h)
  bool materials = false;    ///< pixels are materials: regions of tets, or inputs of triangles
  CleanOptions clean;        ///< of triangles
  int threads = 0;           ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0; ///< bytes for the whole process; 0: what the machine has available
};

struct SliceResult {
  SolidSource source = SolidSource::Triangles;
  std::vector<InputInfo> inputs;
  CleanCounts cleaned;   ///< of triangles, of all inputs
  bool repaired = false; ///< triangles that did not close and were mended where they did not
  bool remeshed = false; ///< triangles whose surface was remade from voxels
  std::string format;    ///< that was written
  LayerFrame frame;
  WorldBox box;          ///< of the model on the plate, millimetres
  double meshVolume = 0; ///< cubic millimetres, by the faces; 0 where they were not needed
  double volume = 0;     ///< cubic millimetres, the sum of the layers before rounding
  double overlap = 0;    ///< cubic millimetres that were counted once though filled more often
  std::size_t emptyLayers = 0;
  std::vector<std::string> materials; ///< names, from material 1 on
  OutputInfo output;
  /// Where SliceJob::keep asks for it: the levels of all pixels, layer by layer, row by row.
  std::vector<std::uint8_t> kept;
};

/// Reads, cleans (triangles), places and cuts the model, and writes layers as they are made.
/// Triangles that do not close once cleaned are mended by repairLocally(), with the warning
/// "repaired"; where that fails their surface is remade from voxels as large as the largest side
/// of a printer's voxel, by the winding number, with the warning "remeshed"; by SliceAa::None, and
/// for materials, the winding number decides at each centre without either. Sheets that enclose
/// nothing are Error(Invalid). Tets are their surface. A volume whose
/// voxels are the printer's, and whose image is not turned, is taken voxel by voxel, its place
/// rounded to whole pixels; any other by the surface that extractSurface() makes of it. Adds stages
/// "read", "clean", "cut" (what is done before the first layer) and "layers" (making and writing
/// them) to `report`. Warns of empty layers ("empty-layers") and of overlap ("overlap"). Throws
/// what the steps throw, Error(Limit) for a model that does not fit on the printer; nothing is
/// written then. Memory: the mesh, 12 bytes a face, and a few layers' runs.
SliceResult run(const SliceJob& job, Report& report, Progress& progress);

} // namespace tetvdb
