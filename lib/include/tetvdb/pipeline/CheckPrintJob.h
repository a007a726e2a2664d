// SPDX-License-Identifier: Apache-2.0
//
// One job from a mesh or a volume to what will fail when it is printed: what `tetvdb check` runs
// for printers.
//
//   tetvdb::CheckPrintJob job;
//   job.slice.inputs = {"part.stl"};
//   job.limits = tetvdb::limitsFor(tetvdb::PrintTarget::Sla);
//   tetvdb::CheckPrintResult result = tetvdb::run(job, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/SliceJob.h"
#include "tetvdb/print/PrintFindings.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

enum class PrintTarget : std::uint8_t {
  Sla,  ///< resin, cured layer by layer
  Lpbf, ///< metal powder, molten by a laser
  Fdm   ///< filament
};

/// What is looked for by default; docs/print.md says where the numbers are from.
PrintLimits limitsFor(PrintTarget target);

/// Sizes where the printer does not say them: layers of 0.05 mm (Sla), 0.03 mm (Lpbf) or 0.2 mm
/// (Fdm); where it has no display, pixels of 0.025 mm, 0.015 mm or 0.05 mm. The plate is then that
/// of the keys for filament printers, bed_shape with first_layer_height, or where these are missing
/// one of 1000 x 1000 pixels, which run() makes as large as the model. Returns whether the plate is
/// known. Throws Error(Invalid) for values of these keys that are none.
bool completePrinter(PrintTarget target, PrinterSettings& printer);

struct CheckPrintJob {
  SliceJob slice; ///< inputs, grid, printer, place, units, clean, threads and maxMemory; aa
  PrintTarget target = PrintTarget::Sla;
  bool plateKnown = true; ///< false: the plate is as large as the model, which is never outside
  bool outside = true;    ///< look whether the model is outside of the printer's space
  PrintLimits limits;
  std::string picture; ///< a PNG file; empty: none
};

/// Where the finding of the same index is.
struct PrintPlace {
  std::array<double, 3> plate{};       ///< millimetres on the plate, of the layer's middle
  std::array<double, 3> model{};       ///< the same place in the input's coordinates and units
  std::array<double, 3> low{}, high{}; ///< the box of all its layers, in the input's coordinates
};

struct CheckPrintResult {
  SliceResult slice; ///< frame: of the printer; larger where the model is outside of it
  PrinterSettings printer;
  PrintLimits limits; ///< that were judged
  PrintChecks checks; ///< pixels are those of the printer's images, also of findings outside
  std::vector<PrintPlace> places;
  /// Millimetres by which the model reaches beyond the printer's space, low and high side of each
  /// axis; 0 where it does not.
  std::array<std::array<double, 2>, 3> beyond{};
};

/// Reads, cleans and places the model as SliceJob does, and looks at its layers, white where the
/// share is a half and more. Where the model is outside of the printer's space it is looked at all
/// the same, standing on the plate, with the finding PrintFault::Outside. Warns of models of less
/// than 1 mm ("size"). Adds stages "read", "clean", "cut", "check" and "picture" to `report`.
/// Throws what the steps throw. Memory: as checkLayers(), the mesh, and for a picture the mesh
/// again.
CheckPrintResult run(const CheckPrintJob& job, Report& report, Progress& progress);

/// The name of a fault in reports: "island", "thin-wall".
const char* nameOf(PrintFault fault);

/// What finding `index` says, one sentence without its end, and what to do.
std::string textOf(const CheckPrintResult& result, std::size_t index);
std::string cureFor(PrintFault fault, PrintTarget target);

} // namespace tetvdb
