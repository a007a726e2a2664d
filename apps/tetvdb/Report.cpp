// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "NumberText.h"
#include "ReportRow.h"
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/MeshFileName.h"
#include "tetvdb/pipeline/JobFiles.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <set>
#include <string>
#include <vector>

namespace tetvdb::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct ReportArguments {
  std::vector<std::string> inputs;
  std::string output;
  ReportSettings settings;
};

const char* const kReportExamples = R"(Examples:
  tetvdb report models/ -o report.html
      every mesh file in the folder and those below it: pictures, defects, numbers, verdict
  tetvdb report a.stl b.obj run.vtu -o report.html --resolution 256 --max-time 60
      these files, a minute at most for each

A model that fails, crashes or takes too long is a row that says so; the report's own status is 0 all
the same. The page is one file, needs no network, and sorts and filters in the browser.)";

std::vector<ReportModel> findModels(const std::vector<std::string>& inputs) {
  std::vector<ReportModel> models;
  for (const std::string& input : inputs) {
    std::error_code error;
    if (!fs::is_directory(input, error)) {
      if (!fs::exists(input, error))
        throw Error(Status::Invalid, input, "there is no such file or folder", "check the path");
      models.push_back({input, fs::path(input).filename().string()});
      continue;
    }
    std::vector<std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(
             input, fs::directory_options::skip_permission_denied, error))
      if (entry.is_regular_file(error) && isMeshFileName(entry.path().string()))
        found.push_back(entry.path().string());
    std::sort(found.begin(), found.end());
    for (const std::string& path : found)
      models.push_back({path, fs::path(path).lexically_relative(input).string()});
  }
  if (models.empty())
    throw Error(Status::Invalid, inputs.front(), "holds no mesh files",
                "name a folder with files that end in " + endingList(FormatUse::ReadMesh) +
                    ", or the files themselves");
  return models;
}

FileNames fileNamesOf(const ReportArguments& options) {
  FileNames names{options.inputs, {options.output}};
  for (const ReportModel& model : findModels(options.inputs))
    names.read.push_back(model.path);
  return names;
}

void runReport(const ReportArguments& options, Session& session) {
  const std::vector<ReportModel> models = findModels(options.inputs);
  requireExtension(options.output, {".html", ".htm"}, "name it .html");
  requireWritable(options.output);
  session.progress.stage("report");
  std::vector<Json> rows;
  std::size_t whole = 0, partial = 0;
  double seconds = 0, pictures = 0;
  for (const ReportModel& model : models) {
    rows.push_back(reportRow(model, options.settings, session.progress));
    const int status = rows.back()["status"];
    whole += status == 0;
    partial += status == 1;
    seconds += rows.back()["seconds"].get<double>();
    pictures += rows.back().value("picture_seconds", 0.0);
    session.progress.update(static_cast<double>(rows.size()) / static_cast<double>(models.size()));
  }
  const std::string page = reportPage(rows, options.settings);
  AtomicFile file(options.output);
  file.write(page.data(), page.size());
  file.commit();

  Json models_ = Json::array();
  for (Json& row : rows) {
    row.erase("picture"); // the page has it
    models_.push_back(std::move(row));
  }
  session.sections["models"] = std::move(models_);
  session.sections["output"] = {{{"path", options.output}, {"bytes", page.size()}}};
  session.sections["seconds"] = seconds;
  session.sections["picture_seconds"] = pictures;
  session.text = fmt::format("{}: {}, {} models: {} done, {} in part, {} without a result; "
                             "{:.1f} s, {:.1f} s of that for pictures\n",
                             options.output, bytesText(page.size()), models.size(), whole, partial,
                             models.size() - whole - partial, seconds, pictures);
  session.textIsSummary = true;
}

} // namespace

Command addReport(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "report", "Many models on one page: pictures, defects, numbers, verdicts");
  auto options = std::make_shared<ReportArguments>();
  command->add_option("DIR|FILE", options->inputs, "Folders, which are searched, and mesh files")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", options->output, "The page")
      ->required()
      ->check(notEmpty())
      ->type_name("OUT.html");
  command
      ->add_option("--resolution", options->settings.resolution,
                   "Voxels along each model's longest side")
      ->check(CLI::Range(1, 4096).description(""))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--max-time", options->settings.maxTime,
                   "Seconds that a model may take; what is not done then is a row that says so")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("S")
      ->capture_default_str();
  command->add_option("--max-memory", options->settings.maxMemory, "As of voxelize, for each model")
      ->check(notEmpty())
      ->type_name("B");
  command->add_option("--mesher", options->settings.mesher, "As of voxelize, for triangles")
      ->check(CLI::IsMember(std::set<std::string>{"auto", "envelope", "winding"}).description(""))
      ->type_name("auto|envelope|winding");
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kReportExamples);
  result.run = [options](Session& session) { runReport(*options, session); };
  result.files = [options] { return fileNamesOf(*options); };
  return result;
}

} // namespace tetvdb::cli
