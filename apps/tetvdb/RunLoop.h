// SPDX-License-Identifier: Apache-2.0
//
// What every command has around it: signals, progress, errors into exit statuses, the report.
#pragma once

#include "Session.h"

#include <functional>
#include <string>

namespace tetvdb::cli {

/// Runs `command` and returns the program's exit status. Errors become one line on stderr; results
/// go to stdout and the report to where --json says, also after an error. The first Ctrl-C cancels
/// the session's progress, a second one ends the program with status 5 and removes temporary files.
int runCommand(const std::string& name, const CommonOptions& options,
               const std::function<void(Session&)>& command);

/// Prints "tetvdb: text" on stderr, as one line whatever `text` holds.
void printError(const std::string& text);

} // namespace tetvdb::cli
