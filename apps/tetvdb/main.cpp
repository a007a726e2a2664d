// SPDX-License-Identifier: Apache-2.0
#include "ChildProgram.h"
#include "Commands.h"
#include "OptionNames.h"
#include "ParseError.h"
#include "RunLoop.h"
#include "Streams.h"
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Version.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <execinfo.h>
#include <iostream>
#include <new>
#include <sstream>
#include <string>
#include <unistd.h>
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
  command.add_flag("--force", options->force,
                   "Replace the FILE of --json though it is no report of this program");
  command.add_flag("--allow-outside", options->allowOutside,
                   "Read files outside of its folder that an input refers to");
  command.add_flag("-q,--quiet", options->quiet,
                   "Print only errors, and warnings where the status is 1");
  command.add_flag("-v,--verbose", options->verbose, "Say what each stage takes");
  return options;
}

namespace {

const char* const kmainExamples = R"(Examples:
  tetvdb voxelize part.msh -o part.vdb --resolution 512
  tetvdb tetrahedralize broken.stl -o solid.msh
  tetvdb info part.msh part.vdb
  tetvdb compare a.vdb b.vdb
  tetvdb repair broken.stl -o whole.stl
  tetvdb convert part.vdb -o part.npz
  tetvdb prepare figure.stl -o hollow.stl --hollow 2
  tetvdb slice part.stl -o part.sl1 --printer sl1s.ini
  tetvdb render part.stl -o part.png
  tetvdb check part.vdb --target blender
  tetvdb report models/ -o report.html
  tetvdb dataset models/ -o voxels --resolution 64
  tetvdb merge part.*-of-16.vdb -o part.vdb
  tetvdb formats
  tetvdb grids

Exit status: 0 done, 1 done but a promise was not met, 2 bad usage, 3 bad input or empty result,
4 memory or size limit, 5 cancelled or timed out, 6 no such device, 7 cannot write, 8 differences
or findings.
Lengths are in the input's own units. 'tetvdb help COMMAND' has each command's options.)";

// 'help' and 'help COMMAND' are '--help' and 'COMMAND --help'.
std::vector<std::string> withoutHelp(std::vector<std::string> words) {
  if (words.empty() || words.front() != "help")
    return words;
  words.erase(words.begin());
  words.resize(std::min<std::size_t>(words.size(), 1));
  words.push_back("--help");
  return words;
}

// The help or the version.
int printAnswer(CLI::App& program, const CLI::Success& asked) {
  std::ostringstream text, errors;
  program.exit(asked, text, errors);
  try {
    printResult(text.str());
    return static_cast<int>(Status::Ok);
  } catch (const Error& error) {
    printMessage(error.what());
    return static_cast<int>(error.status());
  }
}

int runProgram(const std::vector<std::string>& arguments) {
  CLI::App program{"TetVDB: meshes into sparse OpenVDB volumes"};
  program.name("tetvdb");
  program.set_version_flag("--version", std::string("tetvdb ") + version());
  program.require_subcommand(1);
  program.footer(kmainExamples);
  const std::vector<Command> commands = {
      addVoxelize(program),    addTetrahedralize(program), addInfo(program),    addCompare(program),
      addRepair(program),      addConvert(program),        addPrepare(program), addSlice(program),
      addRender(program),      addCheck(program),          addReport(program),  addDataset(program),
      addPlan(program),        addMerge(program),          addFormats(program), addGrids(program),
      addCompletions(program), addManual(program)};
  const std::vector<std::string> words = withoutHelp(arguments);
  // Before '--help', which there is for the program as a whole.
  if (words.size() == 2 && words != arguments && findCommand(words[0], commands) == nullptr) {
    printMessage(describeUnknownCommand(words[0], commands));
    return static_cast<int>(Status::Usage);
  }
  try {
    program.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::Success& asked) { // --help, --version
    return printAnswer(program, asked);
  } catch (const CLI::ParseError& error) {
    printMessage(describeParseError(error, words, program, commands));
    return static_cast<int>(Status::Usage);
  }
  for (const Command& command : commands)
    if (command.parser->parsed())
      return runCommand(command);
  return static_cast<int>(Status::Usage);
}

// An allocation that fails where no exception may leave, in a destructor or in a thread of a
// library.
[[noreturn]] void onTerminate() {
  removeTemporaryFiles();
  try {
    if (const std::exception_ptr error = std::current_exception())
      std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    printOutOfMemory();
    ::_exit(static_cast<int>(Status::Limit));
  } catch (...) {
  }
  std::abort();
}

} // namespace
} // namespace tetvdb::cli

int main(int argc, char** argv) {
  // Errors of write() are reported as such: a closed pipe, a file-size limit.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  std::cout.rdbuf(nullptr); // OpenVDB's log; results go by printResult()
  std::set_terminate(tetvdb::cli::onTerminate);
  void* frame = nullptr;
  ::backtrace(&frame, 1); // loads what ends threads (libgcc), which needs memory
  tetvdb::cli::openClosedStreams();
  tetvdb::cli::endWithParent(SIGTERM);
  try {
    return tetvdb::cli::runProgram({argv + std::min(argc, 1), argv + argc});
  } catch (const std::bad_alloc&) {
    tetvdb::cli::printOutOfMemory();
    return static_cast<int>(tetvdb::Status::Limit);
  } catch (const std::exception& error) {
    tetvdb::cli::printMessage(error.what());
    return static_cast<int>(tetvdb::Status::Invalid);
  }
}
