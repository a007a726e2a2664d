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

/// --printer, and the options that replace properties of it: display, layer heights, turns, the
/// largest height.
void addPrinterOptions(CLI::App& command, PrinterOptions& options);
/// The place and the size of the model: --place, --units, --scale, --stretch, --xy-offset,
/// --foot-offset, --grid.
void addModelOptions(CLI::App& command, PrinterOptions& options);

// The given values, checked; each throws Error(Usage), that of a file Error(Invalid).
PrinterSettings printerFrom(const PrinterOptions& options);
PlaceOptions placeFrom(const PrinterOptions& options);
/// Inputs, grid, units, printer and place.
SliceJob sliceJobFrom(const PrinterOptions& options, const std::vector<std::string>& inputs);

/// A length or time that was asked for replaces `value`; zero or more.
void takeNumber(const std::string& option, const std::string& text, double& value);

} // namespace tetvdb::cli
