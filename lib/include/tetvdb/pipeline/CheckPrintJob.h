// SPDX-License-Identifier: Apache-2.0
//
// Checks a mesh or a volume for features that fail in print: the job of `tetvdb check` for
// printers.
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
  Lpbf, ///< metal powder, melted by a laser
  Fdm   ///< filament
};

/// The default limits of a target; docs/print.md has the sources of the numbers.
PrintLimits limitsFor(PrintTarget target);

/// Sets default sizes that the printer lacks: layers of 0.05 mm (Sla), 0.03 mm (Lpbf) or 0.2 mm
/// (Fdm), and without a display, pixels of 0.025 mm, 0.015 mm or 0.05 mm. The plate is then that of
/// the keys of filament printers, bed_shape with first_layer_height, or without these one of 1000 x
/// 1000 pixels, which run() enlarges to the model. Returns whether the plate is known. Throws
/// Error(Invalid) for invalid values of these keys.
bool completePrinter(PrintTarget target, PrinterSettings& printer);

struct CheckPrintJob {
  SliceJob slice; ///< inputs, grid, printer, placement, units, clean, threads and maxMemory; aa
  PrintTarget target = PrintTarget::Sla;
  bool plateKnown = true; ///< false: the plate is as large as the model
  bool outside = true;    ///< checks whether the model is within the printer's space
  PrintLimits limits;
  std::string picture; ///< a PNG file; empty: none
};

/// The position of the finding with the same index.
struct PrintPlace {
  std::array<double, 3> plate{};       ///< millimetres on the plate, at the layer's middle plane
  std::array<double, 3> model{};       ///< the same point in the input's coordinates and units
  std::array<double, 3> low{}, high{}; ///< the box of all its layers, in the input's coordinates
};

struct CheckPrintResult {
  SliceResult slice; ///< frame: that of the printer, enlarged if the model is outside of it
  PrinterSettings printer;
  PrintLimits limits; ///< the limits in use
  PrintChecks checks; ///< pixels are those of the printer's images, also for findings outside
  std::vector<PrintPlace> places;
  /// Millimetres by which the model exceeds the printer's space, at the low and the high side of
  /// each axis; 0 if it does not.
  std::array<std::array<double, 2>, 3> beyond{};
};

/// Reads, cleans and places the model as SliceJob does, and checks its layers, which are white at
/// shares of at least a half. A model outside of the printer's space is also checked, standing on
/// the plate, with the finding PrintFault::Outside. Warns of models of less than 1 mm ("size").
/// Adds stages "read", "clean", "cut", "check" and "picture" to `report`. Throws the errors of
/// its stages. Memory: that of checkLayers(), the mesh, and for a picture a second copy of the
/// mesh.
CheckPrintResult run(const CheckPrintJob& job, Report& report, Progress& progress);

/// The name of a fault in reports: "island", "thin-wall".
const char* nameOf(PrintFault fault);

/// Describes finding `index` in one sentence without a full stop, followed by advice.
std::string textOf(const CheckPrintResult& result, std::size_t index);
std::string cureFor(PrintFault fault, PrintTarget target);

} // namespace tetvdb
