// SPDX-License-Identifier: Apache-2.0
#include "JsonReport.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Version.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

Json stagesOf(const Report& report) {
  Json stages = Json::array();
  for (const Stage& stage : report.stages) {
    Json parts = Json::array();
    for (const StagePart& part : stage.parts)
      parts.push_back({{"name", part.name}, {"seconds", part.seconds}});
    stages.push_back({{"name", stage.name},
                      {"seconds", stage.seconds},
                      {"peak_bytes", stage.peakBytes},
                      {"parts", std::move(parts)}});
  }
  return stages;
}

Json warningsOf(const Report& report) {
  Json warnings = Json::array();
  for (const Warning& warning : report.warnings)
    warnings.push_back({{"code", warning.code}, {"text", warning.text}});
  return warnings;
}

// Far above what a report of ten thousand inputs has.
constexpr std::uintmax_t kLargestReport = std::uintmax_t(1) << 28;

bool isReport(const std::string& path) {
  std::error_code error;
  if (std::filesystem::file_size(path, error) > kLargestReport || error)
    return false;
  std::ifstream file(path, std::ios::binary);
  if (file.get() != '{')
    return false;
  file.seekg(0);
  const nlohmann::json parsed = nlohmann::json::parse(file, nullptr, false);
  const auto holds = [&](const char* key, auto is) {
    const auto found = parsed.find(key);
    return found != parsed.end() && is(*found);
  };
  const auto isText = [](const nlohmann::json& value) { return value.is_string(); };
  return parsed.is_object() && holds("version", isText) && holds("command", isText) &&
         holds("status", [](const nlohmann::json& value) { return value.is_number_integer(); });
}

} // namespace

void requireReplaceable(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) || std::filesystem::is_empty(path, error))
    return;
  if (!isReport(path))
    throw Error(Status::Usage, path, "exists and is no report of this program",
                "choose another file for --json, or add --force to replace it");
}

std::string reportText(const std::string& command, Status status, const std::string& error,
                       const Session& session) {
  Json all = {{"version", version()}, {"command", command}, {"status", static_cast<int>(status)}};
  if (!error.empty())
    all["error"] = error;
  for (const auto& [key, value] : session.sections.items())
    all[key] = value;
  if (all.contains("stages"))
    all["stages"] = stagesOf(session.report);
  all["warnings"] = warningsOf(session.report);
  // Paths and names may hold any bytes; what is no UTF-8 is replaced.
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void requireWritableReport(const std::string& path) {
  try {
    const AtomicFile probe(path);
  } catch (const Error&) {
    throw Error(Status::Write, path, "cannot create the report", "choose another file for --json");
  }
}

void writeReport(const std::string& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text.data(), text.size());
  file.commit();
}

Json toJson(const GridInfo& grid) {
  return {{"name", grid.name},
          {"type", grid.type},
          {"class", grid.gridClass},
          {"active_voxels", grid.activeVoxels},
          {"active_tiles", grid.activeTiles},
          {"leaves", grid.leaves},
          {"bytes", grid.bytes},
          {"volume", grid.volume},
          {"box", {{"min", grid.boxMin}, {"max", grid.boxMax}}},
          {"min", grid.activeVoxels == 0 ? Json() : Json(grid.minValue)},
          {"max", grid.activeVoxels == 0 ? Json() : Json(grid.maxValue)},
          {"voxel_size", grid.transform.voxelSize},
          {"origin", grid.transform.origin}};
}

Json toJson(const std::vector<GridInfo>& grids) {
  Json list = Json::array();
  for (const GridInfo& grid : grids)
    list.push_back(toJson(grid));
  return list;
}

std::string oneLine(const std::string& text) {
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    line += byte < 0x20 || byte == 0x7f ? ' ' : c;
  }
  while (!line.empty() && line.back() == ' ')
    line.pop_back();
  return line;
}

} // namespace tetvdb::cli
