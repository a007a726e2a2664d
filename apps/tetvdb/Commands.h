// SPDX-License-Identifier: Apache-2.0
//
// The commands, one source file each.
#pragma once

#include "Session.h"

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>

namespace tetvdb::cli {

/// A command as the parser knows it and what it does once its options are parsed.
struct Command {
  CLI::App* parser = nullptr;
  std::shared_ptr<CommonOptions> common;
  std::function<void(Session&)> run;
};

Command addVoxelize(CLI::App& program);
Command addTetrahedralize(CLI::App& program);
Command addInfo(CLI::App& program);
Command addCompare(CLI::App& program);
Command addRepair(CLI::App& program);
Command addRender(CLI::App& program);
Command addCheck(CLI::App& program);
Command addReport(CLI::App& program);
Command addBench(CLI::App& program);

/// Accepts every value but an empty one, which scripts pass by mistake: "$UNSET".
CLI::Validator notEmpty();

/// Adds --json, -q and -v.
std::shared_ptr<CommonOptions> addCommonOptions(CLI::App& command);

} // namespace tetvdb::cli
