// SPDX-License-Identifier: Apache-2.0
//
// `check` for printers.
#pragma once

#include "Commands.h"
#include "JobOptions.h"
#include "PrinterOptions.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tetvdb::cli {

struct CheckPrintOptions : JobOptions, PrinterOptions {
  std::string aa = "area", checks, picture;
  std::string overhangAngle, minWall, minFloor, minGap, drain, minArea, minVolume;
  int connectivity = 8;
};

/// All options of checks for printers.
void addCheckPrintOptions(CLI::App& command, CheckPrintOptions& options);

/// `target`: sla, lpbf or fdm.
void runCheckPrint(const CheckPrintOptions& options, const std::vector<std::string>& files,
                   const std::string& target, Session& session);

} // namespace tetvdb::cli
