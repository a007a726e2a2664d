// SPDX-License-Identifier: Apache-2.0
#include "ReportRow.h"

#include "ChildProgram.h"
#include "TemporaryFolder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>

namespace tetvdb::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string contentOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// RFC 4648.
std::string base64(const std::string& bytes) {
  static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k < bytes.size() + 1 ? letters[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/// Null where there is none, or it is no JSON.
Json jsonOf(const std::string& path) {
  const Json parsed = Json::parse(contentOf(path), nullptr, false);
  return parsed.is_object() ? parsed : Json();
}

/// The first element of a list, or null.
Json firstOf(const Json& report, const char* list) {
  const auto found = report.find(list);
  return found != report.end() && found->is_array() && !found->empty() ? found->front() : Json();
}

Json valueOf(const Json& object, const char* name) {
  return object.is_object() && object.contains(name) ? object[name] : Json();
}

/// Counts of defects, in words; counts of zero are left out.
Json defectsOf(const Json& defects) {
  static const std::array<std::pair<const char*, const char*>, 10> names = {
      {{"boundary_edges", "open edges"},
       {"nonmanifold_edges", "non-manifold edges"},
       {"misoriented_edges", "misoriented edges"},
       {"nonmanifold_vertices", "non-manifold vertices"},
       {"degenerate_faces", "degenerate faces"},
       {"duplicate_faces", "duplicate faces"},
       {"self_intersections", "crossings"},
       {"inverted", "inverted tets"},
       {"flat", "flat tets"},
       {"unreferenced_vertices", "unused vertices"}}};
  Json result = Json::object();
  for (const auto& [name, words] : names) {
    const Json count = valueOf(defects, name);
    if (count.is_number() && count.get<double>() > 0)
      result[words] = count;
  }
  return result;
}

/// The reason why the child wrote no report.
std::string describeEnd(const ChildEnd& end, double maxTime) {
  if (end.status < 0)
    return "the program could not be started";
  if (end.status == 128 + SIGKILL && end.seconds > maxTime)
    return fmt::format("it did not stop after {:.0f} s", end.seconds);
  if (end.status > 128)
    return fmt::format("it was ended by signal {}", end.status - 128);
  return fmt::format("it left no report (status {})", end.status);
}

/// "path: what" becomes "what", and "path:3: what" "line 3: what": the row names the file.
std::string withoutPath(const std::string& error, const std::string& path) {
  if (error.rfind(path + ":", 0) != 0)
    return error;
  const std::string rest = error.substr(path.size() + 1);
  return rest.rfind(' ', 0) == 0 ? rest.substr(1) : "line " + rest;
}

void addVoxelization(const Json& made, Json& row) {
  const Json mesh = valueOf(made, "mesh");
  row["tets"] = valueOf(mesh, "tets");
  row["open_edges"] = valueOf(mesh, "open_edges");
  row["mesher"] = valueOf(valueOf(mesh, "mesher"), "method");
  row["epsilon_reached"] = valueOf(mesh, "epsilon_reached");
  const Json grid = firstOf(made, "grids");
  row["voxels"] = valueOf(grid, "active_voxels");
  row["volume"] = valueOf(grid, "volume");
  Json stages = Json::object();
  for (const Json& stage : valueOf(made, "stages")) { // a name can come several times
    const std::string name = stage.value("name", "");
    stages[name] = stages.value(name, 0.0) + stage.value("seconds", 0.0);
  }
  row["picture_seconds"] = stages.value("preview", 0.0);
  row["stages"] = std::move(stages);
  for (const Json& warning : valueOf(made, "warnings"))
    row["notes"].push_back(warning.value("text", ""));
}

void addPicture(const std::string& path, const Json& made, Json& row) {
  const std::string png = contentOf(path);
  const Json preview = valueOf(made, "preview");
  if (png.empty() || !preview.is_object())
    return;
  row["picture"] = "data:image/png;base64," + base64(png);
  row["panels"] = valueOf(preview, "panels");
  row["width"] = valueOf(preview, "width");
  row["height"] = valueOf(preview, "height");
}

} // namespace

Json reportRow(const ReportModel& model, const ReportSettings& settings, const Progress& progress) {
  const TemporaryFolder folder;
  std::error_code ignored;
  const auto bytes = fs::file_size(model.path, ignored);
  Json row = {{"name", model.name}, {"bytes", ignored ? Json() : Json(bytes)},
              {"format", Json()},   {"kind", Json()},
              {"size", Json()},     {"defects", Json::object()},
              {"verdict", Json()},  {"notes", Json::array()},
              {"picture", Json()},  {"panels", Json::array()},
              {"tets", Json()},     {"voxels", Json()}};

  // '--' would not do: a name that begins with a dash is given with its folder.
  const std::string path = fs::path(model.path).is_relative() ? "./" + model.path : model.path;
  const double atMost = settings.maxTime + 30; // the child stops itself before
  const ChildEnd look =
      runThisProgram({"info", path, "--json", folder.file("info.json"), "-q"}, atMost, progress);
  const Json info = jsonOf(folder.file("info.json"));
  const Json input = firstOf(info, "input");
  if (input.is_object()) {
    row["format"] = valueOf(input, "format");
    row["kind"] = valueOf(input, "kind");
    const bool tets = row["kind"] == "tets";
    row["size"] = valueOf(input, tets ? "tets" : "triangles");
    row["defects"] = defectsOf(valueOf(input, "defects"));
    row["verdict"] = valueOf(input, "verdict");
  }

  std::vector<std::string> arguments = {"voxelize",
                                        path,
                                        "-o",
                                        folder.file("volume.vdb"),
                                        "--resolution",
                                        std::to_string(settings.resolution),
                                        "--preview",
                                        folder.file("picture.png"),
                                        "--max-time",
                                        fmt::format("{}", settings.maxTime),
                                        "--json",
                                        folder.file("made.json"),
                                        "-q"};
  if (settings.mesher != "auto" && row["kind"] == "triangles")
    arguments.insert(arguments.end(), {"--mesher", settings.mesher});
  if (!settings.maxMemory.empty())
    arguments.insert(arguments.end(), {"--max-memory", settings.maxMemory});
  const ChildEnd end = runThisProgram(arguments, atMost, progress);
  const Json made = jsonOf(folder.file("made.json"));
  row["status"] = end.status;
  row["seconds"] = look.seconds + end.seconds;
  row["megabytes"] = static_cast<double>(std::max(look.peakBytes, end.peakBytes)) / 1e6;
  if (made.is_object()) {
    addVoxelization(made, row);
    addPicture(folder.file("picture.png"), made, row);
    const std::string error = made.value("error", "");
    if (!error.empty())
      row["verdict"] = withoutPath(error, path);
  } else {
    row["verdict"] = describeEnd(end, atMost);
  }
  return row;
}

} // namespace tetvdb::cli
