// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "JsonReport.h"
#include "NumberText.h"
#include "tetvdb/io/MergeVdb.h"
#include "tetvdb/pipeline/JobFiles.h"

#include <fmt/format.h>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct MergeArguments {
  std::vector<std::string> parts;
  std::string output;
  bool allowEmpty = false;
};

const char* const kMergeExamples = R"(Examples:
  tetvdb merge ship.*-of-16.vdb -o ship.vdb
      one volume of the 16 parts that 'tetvdb voxelize --shard' has written, in any order: the same
      file that one process would have written

Parts that are missing, cut, given twice or of another volume are refused by name.)";

void runMerge(const MergeArguments& options, Session& session) {
  Json inputs = Json::array();
  for (const std::string& path : options.parts)
    inputs.push_back({{"path", path}});
  session.sections = {{"input", inputs}, {"stages", nullptr}, {"output", Json::array()}};
  requireExtension(options.output, {".vdb"}, "name it .vdb");
  requireWritable(options.output);
  MergeOptions merge;
  merge.allowEmpty = options.allowEmpty;
  MergeResult result;
  {
    StageTimer timer(session.report, "write");
    result = mergeVdb(options.parts, options.output, merge, session.progress);
  }
  const OutputInfo output = written(options.output);
  session.sections["output"].push_back({{"path", output.path},
                                        {"bytes", output.bytes},
                                        {"active_voxels", result.activeVoxels},
                                        {"leaves", result.leaves}});
  session.text =
      fmt::format("{}: {}, {} parts, {} active voxels, {} leaves\n", oneLine(output.path),
                  bytesText(output.bytes), result.parts, result.activeVoxels, result.leaves);
  session.textIsSummary = true;
}

} // namespace

Command addMerge(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("merge", "Join the parts of a volume that shards have made");
  auto options = std::make_shared<MergeArguments>();
  command->add_option("PART", options->parts, "All parts of one volume, in any order")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", options->output, "The volume: .vdb")
      ->required()
      ->type_name("FILE")
      ->check(notEmpty());
  command->add_flag("--allow-empty", options->allowEmpty, "Write a volume without voxels too");
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kMergeExamples);
  result.run = [options](Session& session) { runMerge(*options, session); };
  result.files = [options] { return FileNames{options->parts, {options->output}}; };
  return result;
}

} // namespace tetvdb::cli
