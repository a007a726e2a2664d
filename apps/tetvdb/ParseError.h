// SPDX-License-Identifier: Apache-2.0
//
// Describes an error of the command line in one line, with advice.
#pragma once

#include "Commands.h"

#include <string>
#include <vector>

namespace tetvdb::cli {

/// For an error of parsing `words`, the program's name left out. An option, a command or a value
/// that does not exist comes with the one that is spelled nearly so.
std::string describeParseError(const CLI::ParseError& error, const std::vector<std::string>& words,
                               const CLI::App& program, const std::vector<Command>& commands);

/// The command of that name, or null.
const Command* findCommand(const std::string& name, const std::vector<Command>& commands);

/// For a name that is no command's.
std::string describeUnknownCommand(const std::string& name, const std::vector<Command>& commands);

} // namespace tetvdb::cli
