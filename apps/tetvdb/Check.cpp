// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "JsonReport.h"
#include "OptionNames.h"
#include "tetvdb/pipeline/CheckVolumes.h"

#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <string>
#include <vector>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::vector<std::string> files;
  std::string target = "blender";
};

const char* const kExamples = R"(Examples:
  tetvdb check smoke.vdb
      whether Blender will show it, and if not what to do
  tetvdb check run.0*.vdb --target houdini
      the frames of a sequence, each and together

Exit status: 0 where nothing is wrong (notes do not count), 8 where something is, 3 for a file that
cannot be read.)";

std::string wordFor(Finding::Weight weight) {
  switch (weight) {
  case Finding::Weight::Error:
    return "error";
  case Finding::Weight::Warning:
    return "warning";
  case Finding::Weight::Note:
    break;
  }
  return "note";
}

void runCheck(const Options& options, Session& session) {
  Json inputs = Json::array();
  for (const std::string& file : options.files)
    inputs.push_back({{"path", file}});
  session.sections = {{"target", options.target}, {"input", inputs}, {"findings", Json::array()}};
  CheckOptions check;
  check.target = options.target == "houdini" ? CheckTarget::Houdini : CheckTarget::Blender;
  const std::vector<Finding> findings = checkVolumes(options.files, check, session.progress);
  std::size_t wrong = 0;
  for (const Finding& finding : findings) {
    session.sections["findings"].push_back({{"weight", wordFor(finding.weight)},
                                            {"code", finding.code},
                                            {"file", finding.file},
                                            {"grid", finding.grid},
                                            {"text", withOptionNames(finding.text)},
                                            {"cure", withOptionNames(finding.cure)}});
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
      program.add_subcommand("check", "Say whether a volume will show in Blender or Houdini");
  auto options = std::make_shared<Options>();
  command->add_option("FILE", options->files, "Volumes; several are the frames of a sequence")
      ->required()
      ->type_name("");
  command->add_option("--target", options->target, "The program that will open it")
      ->check(CLI::IsMember(std::set<std::string>{"blender", "houdini"}).description(""))
      ->type_name("blender|houdini");
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kExamples);
  result.run = [options](Session& session) { runCheck(*options, session); };
  result.files = [options] { return FileNames{options->files, {}}; };
  return result;
}

} // namespace tetvdb::cli
