// SPDX-License-Identifier: Apache-2.0
//
// Options of commands that cut a model into a printer's layers.
#pragma once

#include "tetvdb/pipeline/SliceJob.h"

#include <CLI/CLI.hpp>
#include <string>

namespace tetvdb::cli {

struct PrinterOptions {
  std::string printer, pixels, display, layerHeight, firstLayerHeight;
  std::string orientation, mirror, maxHeight, stretch, xyOffset, footOffset;
  std::string place, units, grid;
  double scale = 1;
};

/// --printer, and what of it can be replaced: display, layer heights, turns, the largest height.
void addPrinterOptions(CLI::App& command, PrinterOptions& options);
/// Where the model goes and how large it is: --place, --units, --scale, --stretch, --xy-offset,
/// --foot-offset, --grid.
void addModelOptions(CLI::App& command, PrinterOptions& options);

// What was given, checked; each throws Error(Usage), that of a file Error(Invalid).
PrinterSettings printerFrom(const PrinterOptions& options);
PlaceOptions placeFrom(const PrinterOptions& options);
/// Inputs, grid, units, printer and place.
SliceJob sliceJobFrom(const PrinterOptions& options, const std::vector<std::string>& inputs);

/// A length or time that was asked for replaces `value`; zero or more.
void takeNumber(const std::string& option, const std::string& text, double& value);

} // namespace tetvdb::cli
