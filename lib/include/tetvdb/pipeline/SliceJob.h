// SPDX-License-Identifier: Apache-2.0
//
// Cuts a mesh or a volume into a printer's layers: the job of `tetvdb slice`.
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

/// The meaning of a pixel's level.
enum class SliceAa : std::uint8_t {
  Volume, ///< the solid share of the voxel
  Area,   ///< the solid share of the pixel in the layer's middle plane
  None    ///< white if the voxel's centre is in the solid (voxelize/Ownership.h)
};

struct SliceJob {
  /// Meshes of triangles or of tets, or a volume, files or in `memory`; several, of triangles, are
  /// combined at their given positions.
  std::vector<std::string> inputs;
  MemoryInputs memory;
  bool isVolume = false;   ///< the input is a .vdb or .nvdb file, or a volume
  std::string grid;        ///< of a volume, by name; empty: the first that defines a solid
  std::string output;      ///< a file, or a folder; empty, with `keep`: none
  bool keep = false;       ///< returns the layers instead of writing them
  std::string format;      ///< as LayerFormat::name; empty: by the output's ending
  PrinterSettings printer; ///< checked by checkPrinter()
  PlaceOptions place;
  std::string units; ///< of the input, as metresOf(); empty: that of the file, else millimetres
  SliceAa aa = SliceAa::Volume;
  GreyOptions grey;
  bool dither = false;       ///< levels by error diffusion (print/ErrorDiffusion.h)
  bool materials = false;    ///< pixels are materials: regions of tets, or inputs of triangles
  CleanOptions clean;        ///< of triangles
  int threads = 0;           ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0; ///< bytes for the whole process; 0: the available memory
};

struct SliceResult {
  SolidSource source = SolidSource::Triangles;
  std::vector<InputInfo> inputs;
  CleanCounts cleaned;   ///< of triangles, all inputs
  bool repaired = false; ///< triangles were not closed and were repaired in place
  bool remeshed = false; ///< the surface of the triangles was remade from voxels
  std::string format;    ///< of the written file
  LayerFrame frame;
  WorldBox box;          ///< of the model on the plate, millimetres
  double meshVolume = 0; ///< cubic millimetres, by the faces; 0 if not needed
  double volume = 0;     ///< cubic millimetres, the sum of the layers before rounding
  double overlap = 0;    ///< cubic millimetres of multiple coverage that were counted once
  std::size_t emptyLayers = 0;
  std::vector<std::string> materials; ///< names, starting with material 1
  OutputInfo output;
  /// If SliceJob::keep is set: the levels of all pixels, layer by layer, row by row.
  std::vector<std::uint8_t> kept;
};

/// Reads, cleans (triangles), places and cuts the model, and writes layers as they are made.
/// Triangles that are not closed after cleaning are repaired by repairLocally(), with the warning
/// "repaired"; if that fails, their surface is remade from voxels as large as the largest side of a
/// printer's voxel, by the winding number, with the warning "remeshed". With SliceAa::None, and for
/// materials, the winding number decides at each centre without either. Sheets that enclose nothing
/// are Error(Invalid). Tets are replaced by their surface. A volume whose voxels match the
/// printer's, and whose image is not rotated, is used voxel by voxel, with its position rounded to
/// whole pixels; other volumes by the result of extractSurface(). Adds stages "read", "clean",
/// "cut" (before the first layer) and "layers" (making and writing them) to `report`. Warns of
/// empty layers ("empty-layers") and of overlap ("overlap"). Throws the errors of its stages, and
/// Error(Limit) for a model that does not fit on the printer; nothing is written then. Memory: the
/// mesh, 12 bytes per face, and the runs of a few layers.
SliceResult run(const SliceJob& job, Report& report, Progress& progress);

} // namespace tetvdb
