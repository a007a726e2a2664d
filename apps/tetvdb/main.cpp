// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "RunLoop.h"
#include "tetvdb/core/Version.h"

#include <csignal>
#include <string>
#include <vector>

namespace tetvdb::cli {

CLI::Validator notEmpty() {
  return CLI::Validator(
      [](std::string& value) { return std::string(value.empty() ? "the value is empty" : ""); },
      "");
}

std::shared_ptr<CommonOptions> addCommonOptions(CLI::App& command) {
  auto options = std::make_shared<CommonOptions>();
  command
      .add_option("--json", options->json, "Write a machine-readable report to FILE, - for stdout")
      ->type_name("FILE")
      ->check(notEmpty());
  command.add_flag("-q,--quiet", options->quiet, "Print errors alone");
  command.add_flag("-v,--verbose", options->verbose, "Say what each stage takes");
  return options;
}

namespace {

const char* const kExamples = R"(Examples:
  tetvdb voxelize part.msh -o part.vdb --resolution 512
  tetvdb tetrahedralize broken.stl -o solid.msh
  tetvdb info part.msh part.vdb
  tetvdb compare a.vdb b.vdb
  tetvdb repair broken.stl -o whole.stl
  tetvdb render part.stl -o part.png
  tetvdb check part.vdb --target blender
  tetvdb report models/ -o report.html
  tetvdb bench

Exit status: 0 done, 1 done but a promise was not met, 2 bad usage, 3 bad input or empty result,
4 memory or size limit, 5 cancelled or timed out, 6 no such device, 7 cannot write, 8 differences
or findings.
Lengths are in the input's own units. 'tetvdb COMMAND --help' has each command's options.)";

std::string describeParseError(const CLI::ParseError& error, int argc, char** argv,
                               const std::vector<Command>& commands) {
  std::string help = "tetvdb --help";
  bool known = false;
  for (const Command& command : commands) {
    if (argc < 2 || command.parser->get_name() != argv[1])
      continue;
    known = true;
    help = "tetvdb " + command.parser->get_name() + " --help";
  }
  std::string text = error.what();
  if (argc < 2)
    text = "a command is missing";
  else if (!known && argv[1][0] != '-')
    text = "'" + std::string(argv[1]) +
           "' is no command; there are voxelize, tetrahedralize, info, compare, repair, render, "
           "check, report and bench";
  return text + "; see '" + help + "'";
}

int runProgram(int argc, char** argv) {
  CLI::App program{"TetVDB: tetrahedral meshes into sparse OpenVDB volumes"};
  program.name("tetvdb");
  program.set_version_flag("--version", std::string("tetvdb ") + version());
  program.require_subcommand(1);
  program.footer(kExamples);
  const std::vector<Command> commands = {
      addVoxelize(program), addTetrahedralize(program), addInfo(program),
      addCompare(program),  addRepair(program),         addRender(program),
      addCheck(program),    addReport(program),         addBench(program)};
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& asked) { // --help, --version
    return program.exit(asked);
  } catch (const CLI::ParseError& error) {
    printError(describeParseError(error, argc, argv, commands));
    return static_cast<int>(Status::Usage);
  }
  for (const Command& command : commands)
    if (command.parser->parsed())
      return runCommand(command.parser->get_name(), *command.common, command.run);
  return static_cast<int>(Status::Usage);
}

} // namespace
} // namespace tetvdb::cli

int main(int argc, char** argv) {
  // Errors of write() are reported as such: a closed pipe, a file-size limit.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return tetvdb::cli::runProgram(argc, argv);
  } catch (const std::exception& error) {
    tetvdb::cli::printError(error.what());
    return static_cast<int>(tetvdb::Status::Invalid);
  }
}
