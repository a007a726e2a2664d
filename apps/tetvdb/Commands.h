// SPDX-License-Identifier: Apache-2.0
//
// The commands, one source file each.
#pragma once

#include "Session.h"

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb::cli {

/// The files of a command, as its options name them. Patterns and lists of files stand for the
/// files that they represent; empty names are ignored.
struct FileNames {
  std::vector<std::string> read, written;
};

/// A command of the parser, and the function that runs after its options are parsed.
struct Command {
  CLI::App* parser = nullptr;
  std::shared_ptr<CommonOptions> common;
  std::function<void(Session&)> run;
  std::function<FileNames()> files = {}; ///< all but the report; throws nothing but Error
};

Command addVoxelize(CLI::App& program);
Command addTetrahedralize(CLI::App& program);
Command addInfo(CLI::App& program);
Command addCompare(CLI::App& program);
Command addRepair(CLI::App& program);
Command addConvert(CLI::App& program);
Command addPrepare(CLI::App& program);
Command addSlice(CLI::App& program);
Command addRender(CLI::App& program);
Command addCheck(CLI::App& program);
Command addReport(CLI::App& program);
Command addDataset(CLI::App& program);
Command addPlan(CLI::App& program);
Command addMerge(CLI::App& program);
Command addFormats(CLI::App& program);
Command addGrids(CLI::App& program);
Command addCompletions(CLI::App& program);
Command addManual(CLI::App& program);

/// Accepts every value but an empty one, which scripts pass by mistake: "$UNSET".
CLI::Validator notEmpty();

/// Adds --json, --force, --allow-outside, -q and -v.
std::shared_ptr<CommonOptions> addCommonOptions(CLI::App& command);

} // namespace tetvdb::cli
