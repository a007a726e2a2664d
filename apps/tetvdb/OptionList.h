// SPDX-License-Identifier: Apache-2.0
//
// The commands and options of the parser, for texts that are made of them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tetvdb::cli {

struct ListedOption {
  std::vector<std::string> names; ///< "-o", "--output"; of a positional its name alone
  std::string value;              ///< its argument: "FILE"; empty: none
  std::string initial;            ///< its default; empty if none is shown
  std::string about;
  bool positional = false, required = false;
};

/// The commands of the program, in the order of its help.
std::vector<const CLI::App*> commandsOf(const CLI::App& program);

/// The positionals and the options of a command that its help shows, in that order.
std::vector<ListedOption> optionsOf(const CLI::App& command);

} // namespace tetvdb::cli
