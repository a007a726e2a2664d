// SPDX-License-Identifier: Apache-2.0
//
// The layout: OpenFOAM User Guide, "File structure of OpenFOAM cases", "Decomposition of mesh and
// initial field data".
#include "tetvdb/io/formats/openfoam/FoamCase.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/PathWithin.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <utility>

namespace tetvdb::openfoam {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMesh = "polyMesh";

std::string joined(const std::string& a, const std::string& b) {
  return a.empty() ? b : b.empty() ? a : a + "/" + b;
}

// Names of the folders, or of the files, in a folder, ascending; none where there is none.
std::vector<std::string> namesIn(const std::string& folder, bool folders) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code unused;
    if (folders ? at->is_directory(unused) : at->is_regular_file(unused))
      names.push_back(at->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

// The number N of a folder "processorN"; -1 for others.
int processorOf(const std::string& name) {
  constexpr std::size_t kPrefix = 9;
  int number = -1;
  if (name.compare(0, kPrefix, "processor") != 0)
    return -1;
  const char* const end = name.data() + name.size();
  const auto [stop, status] = std::from_chars(name.data() + kPrefix, end, number);
  return status == std::errc() && stop == end ? number : -1;
}

} // namespace

FoamCase::FoamCase(const Source& source) : path_(source.path) {
  const fs::path path(source.path);
  const fs::path folder = path.parent_path();
  folder_ =
      (path.extension() == "" && folder.filename() == "system" ? folder.parent_path() : folder)
          .string();
  if (folder_.empty())
    folder_ = ".";
  std::vector<std::pair<int, std::string>> processors;
  bool isCollated = false;
  for (const std::string& name : namesIn(folder_, true)) {
    const int number = processorOf(name);
    if (number >= 0)
      processors.emplace_back(number, name);
    isCollated = isCollated || name.compare(0, 10, "processors") == 0;
  }
  std::sort(processors.begin(), processors.end());
  takeParts("", parts_);
  takeTimes("", times_, timeNames_);
  if (!processors.empty()) {
    std::vector<CasePart> parts;
    for (const auto& [number, name] : processors)
      takeParts(name, parts);
    std::vector<double> times;
    std::vector<std::string> names;
    takeTimes(processors.front().second, times, names);
    // What a parallel run wrote, unless it has been put together since.
    const bool isLater = !times.empty() && (times_.empty() || times.back() > times_.back());
    if (!parts.empty() && (parts_.empty() || isLater)) {
      parts_ = std::move(parts);
      times_ = std::move(times);
      timeNames_ = std::move(names);
    }
  }
  if (parts_.empty())
    throw Error(Status::Invalid, path_,
                isCollated ? "the case is decomposed in collated files, which are not read"
                           : "its folder holds no mesh (constant/polyMesh)",
                isCollated ? "put it together by reconstructPar"
                           : "put the file into the folder of an OpenFOAM case");
}

bool FoamCase::hasFolder(const std::string& name) const {
  std::error_code error;
  return fs::is_directory(fs::path(folder_) / name, error);
}

std::optional<std::string> FoamCase::file(const std::string& name) const {
  std::error_code error;
  for (const std::string& found : {name, name + ".gz"})
    if (fs::exists(fs::path(folder_) / found, error))
      return pathWithin((fs::path(folder_) / "case").string(), found);
  return {};
}

// Of one mesh, or of those of several regions.
void FoamCase::takeParts(const std::string& folder, std::vector<CasePart>& parts) const {
  const std::string constant = joined(folder, "constant");
  if (hasFolder(joined(constant, kMesh))) {
    parts.push_back({folder, ""});
    return;
  }
  for (const std::string& name : namesIn((fs::path(folder_) / constant).string(), true))
    if (hasFolder(joined(joined(constant, name), kMesh)))
      parts.push_back({folder, name});
}

void FoamCase::takeTimes(const std::string& folder, std::vector<double>& times,
                         std::vector<std::string>& names) const {
  std::vector<std::pair<double, std::string>> found;
  for (const std::string& name : namesIn((fs::path(folder_) / folder).string(), true)) {
    double time = 0;
    const char* const end = name.data() + name.size();
    const auto [stop, status] = std::from_chars(name.data(), end, time);
    if (status == std::errc() && stop == end && std::isfinite(time)) // a folder may be named "nan"
      found.emplace_back(time, name);
  }
  std::sort(found.begin(), found.end());
  for (auto& [time, name] : found) {
    times.push_back(time);
    names.push_back(std::move(name));
  }
}

std::optional<std::string> FoamCase::meshFile(const CasePart& part, std::optional<std::size_t> time,
                                              const std::string& name) const {
  const auto at = [&](const std::string& when) {
    return file(
        joined(joined(joined(part.folder, when), part.region), std::string(kMesh) + "/" + name));
  };
  if (time)
    for (std::size_t i = *time + 1; i-- > 0;)
      if (const auto found = at(timeNames_[i]))
        return found;
  return at("constant");
}

std::vector<FieldFile> FoamCase::fields(const CasePart& part, std::size_t time) const {
  const std::string folder = joined(joined(part.folder, timeNames_[time]), part.region);
  std::vector<FieldFile> fields;
  for (std::string name : namesIn((fs::path(folder_) / folder).string(), false)) {
    constexpr std::string_view kGz = ".gz";
    if (name.size() > kGz.size() && name.compare(name.size() - kGz.size(), kGz.size(), kGz) == 0)
      name.resize(name.size() - kGz.size());
    if (name.find('.') == 0 || (!fields.empty() && fields.back().name == name))
      continue;
    if (const auto path = file(joined(folder, name)))
      fields.push_back({name, *path});
  }
  return fields;
}

} // namespace tetvdb::openfoam
