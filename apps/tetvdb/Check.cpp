// SPDX-License-Identifier: Apache-2.0
#include "CheckPrint.h"
#include "CheckReport.h"
#include "Commands.h"
#include "JsonReport.h"
#include "OptionNames.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/CheckVolumes.h"

#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <string>
#include <vector>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CheckArguments {
  std::vector<std::string> files;
  std::string target = "blender";
  CheckPrintOptions print;
};

const char* const kCheckExamples = R"(Examples:
  tetvdb check smoke.vdb
      whether Blender will show it, and if not what to do
  tetvdb check run.0*.vdb --target houdini
      the frames of a sequence, each and together
  tetvdb check part.stl --target sla --printer sl1s.ini
      what will fail when it is printed: islands, overhangs, cups, traps, narrow drains, thin walls
      and gaps, each with its layer, place and size
  tetvdb check part.stl --target sla --checks islands,cups --min-area 0.01 --json report.json
  tetvdb check bracket.3mf --target lpbf --overhang-angle 40 --min-wall 0.5
  tetvdb check part.stl --target fdm --printer mk4.ini
  tetvdb check part.stl --target fdm --layer-height 0.3
      without a printer: pixels of 0.05 mm, as large a plate as the model needs

For printers FILE is a mesh of triangles (several are put together) or of tets, or a volume. All
lengths are in millimetres. docs/print.md says what is found and how.

Exit status: 0 where nothing is wrong (notes do not count), 8 where something is, 3 for a file that
cannot be read.)";

bool isPrinter(const std::string& target) {
  return target == "sla" || target == "lpbf" || target == "fdm";
}

// Options of checks for printers mean nothing for others.
void requireNone(const std::vector<CLI::Option*>& options, const std::string& target) {
  for (const CLI::Option* option : options)
    if (option->count() > 0)
      throw Error(Status::Usage, option->get_name(), "is for printers, not for " + target,
                  "leave it out, or choose --target sla, lpbf or fdm");
}

void runCheck(const CheckArguments& options, Session& session) {
  Json inputs = Json::array();
  for (const std::string& file : options.files)
    inputs.push_back({{"path", file}});
  session.sections = {{"target", options.target}, {"input", inputs}, {"findings", Json::array()}};
  CheckOptions check;
  check.target = options.target == "houdini" ? CheckTarget::Houdini : CheckTarget::Blender;
  const std::vector<Finding> findings = checkVolumes(options.files, check, session.progress);
  std::size_t wrong = 0;
  for (const Finding& finding : findings) {
    session.sections["findings"].push_back(toJson(finding, withOptionNames));
    session.text +=
        fmt::format("{}: {}{} {}; {} [{}]\n", wordFor(finding.weight), oneLine(finding.file),
                    finding.grid.empty() ? ":" : ": '" + oneLine(finding.grid) + "'",
                    oneLine(withOptionNames(finding.text)), oneLine(withOptionNames(finding.cure)),
                    finding.code);
    wrong += finding.weight == Finding::Weight::Note ? 0 : 1;
  }
  session.text += wrong == 0 ? fmt::format("{} file{}: nothing wrong\n", options.files.size(),
                                           options.files.size() == 1 ? "" : "s")
                             : fmt::format("{} thing{} wrong\n", wrong, wrong == 1 ? "" : "s");
  session.textIsSummary = true;
  if (wrong > 0)
    session.status = Status::Found;
}

} // namespace

Command addCheck(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("check", "Say whether a volume will show, or a model can be printed");
  auto options = std::make_shared<CheckArguments>();
  command
      ->add_option(
          "FILE", options->files,
          "Volumes; several are the frames of a sequence. For printers: meshes, or a volume")
      ->required()
      ->type_name("");
  command
      ->add_option(
          "--target", options->target,
          "The program that will open it, or the kind of printer: resin, metal powder, filament")
      ->check(CLI::IsMember(std::set<std::string>{"blender", "houdini", "sla", "lpbf", "fdm"})
                  .description(""))
      ->type_name("blender|houdini|sla|lpbf|fdm");
  const std::size_t before = command->get_options().size();
  addCheckPrintOptions(*command, options->print);
  std::vector<CLI::Option*> print = command->get_options();
  print.erase(print.begin(), print.begin() + static_cast<std::ptrdiff_t>(before));
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kCheckExamples);
  result.run = [options, print](Session& session) {
    if (isPrinter(options->target))
      return runCheckPrint(options->print, options->files, options->target, session);
    requireNone(print, options->target);
    runCheck(*options, session);
  };
  result.files = [options] { return FileNames{options->files, {options->print.picture}}; };
  return result;
}

} // namespace tetvdb::cli
