// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/Formats.h"

#include "Commands.h"

#include <fmt/format.h>
#include <string>
#include <vector>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

const char* const kFormatsExamples = R"(Examples:
  tetvdb formats
      what is read and written, a line a format
  tetvdb formats --json -
      the same for programs

What a file is, its content decides; its name only where the content tells nothing.)";

std::vector<std::string> heldBy(const Format& format) {
  std::vector<std::string> things;
  const auto add = [&](unsigned thing, const char* name) {
    if ((format.holds & thing) != 0)
      things.emplace_back(name);
  };
  add(holds::kTets, "tets");
  add(holds::kTriangles, "triangles");
  add(holds::kVolume, "volume");
  add(holds::kArrays, "arrays");
  add(holds::kSteps, "steps");
  return things;
}

bool isRead(const Format& format) {
  return can(format, FormatUse::ReadMesh) || can(format, FormatUse::ReadVolume);
}

bool isWritten(const Format& format) {
  return can(format, FormatUse::WriteTets) || can(format, FormatUse::WriteTriangles) ||
         can(format, FormatUse::WriteVolume) || can(format, FormatUse::WriteArrays);
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

void runFormats(Session& session) {
  Json rows = Json::array();
  session.text =
      fmt::format("{:<22} {:<18} {:<11} {:<32} {}\n", "format", "endings", "", "holds", "");
  for (const Format& format : formats()) {
    rows.push_back({{"name", format.name},
                    {"endings", endingsOf(format)},
                    {"description", format.description},
                    {"holds", heldBy(format)},
                    {"read", isRead(format)},
                    {"written", isWritten(format)},
                    {"steps_in_one_file", can(format, FormatUse::ReadSteps)}});
    session.text += fmt::format("{:<22} {:<18} {:<11} {:<32} {}\n", format.name, format.endings,
                                !isRead(format)     ? "write"
                                : isWritten(format) ? "read, write"
                                                    : "read",
                                joined(heldBy(format)), format.description);
  }
  session.sections["formats"] = std::move(rows);
}

} // namespace

Command addFormats(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("formats", "List the file formats that are read and written");
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kFormatsExamples);
  result.run = [](Session& session) { runFormats(session); };
  result.files = [] { return FileNames{}; };
  return result;
}

} // namespace tetvdb::cli
