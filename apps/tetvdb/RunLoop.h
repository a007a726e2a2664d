// SPDX-License-Identifier: Apache-2.0
//
// The frame of every command: handles signals, files, progress, errors and exit statuses, and the
// report.
#pragma once

#include "Commands.h"

namespace tetvdb::cli {

/// Runs `command` and returns the program's exit status. A command whose files conflict
/// (core/FileUse.h) is refused before it does anything. Errors become one line on stderr; results
/// go to stdout and the report to where --json says, also after an error. The first Ctrl-C cancels
/// the session's progress; a second one, or 20 seconds, end the program with status 5 and remove
/// temporary files.
int runCommand(const Command& command);

} // namespace tetvdb::cli
