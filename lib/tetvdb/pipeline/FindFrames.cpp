// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/FindFrames.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/formats/vtk/VtuMarkup.h"
#include "tetvdb/io/source/PathWithin.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/pipeline/NumberedPath.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

bool exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

bool isCollection(const std::string& path) {
  return endingOf(path) == ".pvd";
}

// '*' matches any characters, '?' one.
bool matches(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0, star = std::string_view::npos, mark = 0;
  while (n < name.size()) {
    if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n]) && pattern[p] != '*') {
      ++p;
      ++n;
    } else if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      mark = n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++mark;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*')
    ++p;
  return p == pattern.size();
}

struct NumberedFile {
  unsigned long long number;
  std::string path;
};

// The files whose names match, unordered.
std::vector<std::string> filesLike(const std::string& pattern) {
  const fs::path path(pattern);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (folder.string().find_first_of("*?") != std::string::npos)
    throw Error(Status::Usage, pattern, "has '*' or '?' in the name of a folder",
                "use them in the file's name only");
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error)
    throw Error(Status::Invalid, folder.string(), "cannot be listed: " + error.message());
  std::vector<std::string> found;
  for (const fs::directory_entry& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (matches(path.filename().string(), name) && entry.is_regular_file(error))
      found.push_back(path.has_parent_path() ? entry.path().string() : name);
  }
  if (found.empty())
    throw Error(Status::Invalid, pattern, "no file matches");
  return found;
}

// One frame per file, in the order of their numbers. `what` names the files in messages.
std::vector<Frame> framesByNumber(const std::vector<std::string>& paths, const std::string& what,
                                  bool allowGaps) {
  std::vector<NumberedFile> files;
  for (const std::string& path : paths) {
    const NumberedPath name(path);
    if (!name.number)
      throw Error(Status::Invalid, path, "has no number in its name, by which frames are ordered",
                  "use a narrower pattern");
    files.push_back({*name.number, path});
  }
  std::sort(files.begin(), files.end(), [](const NumberedFile& a, const NumberedFile& b) {
    return std::tie(a.number, a.path) < std::tie(b.number, b.path);
  });
  unsigned long long step = 0;
  for (std::size_t i = 1; i < files.size(); ++i) {
    const unsigned long long between = files[i].number - files[i - 1].number;
    if (between == 0)
      throw Error(Status::Invalid, files[i].path,
                  fmt::format("has the number {} as '{}' has", files[i].number, files[i - 1].path),
                  "use a narrower pattern");
    step = step == 0 ? between : std::min(step, between);
  }
  for (std::size_t i = 1; i < files.size() && !allowGaps; ++i)
    if (files[i].number - files[i - 1].number != step)
      throw Error(Status::Invalid, what,
                  fmt::format("number {} is missing: '{}' follows '{}'", files[i - 1].number + step,
                              files[i].path, files[i - 1].path),
                  "add it, or use `allow_gaps` to continue with the next one");
  std::vector<Frame> frames;
  for (NumberedFile& file : files)
    frames.push_back({{std::move(file.path)}, -1, {}});
  return frames;
}

std::vector<Frame> framesOfCollection(const std::string& path) {
  const MappedFile file(path);
  const vtk::VtuMarkup markup(file.source());
  const pugi::xml_node collection = markup.root().child("Collection");
  if (!collection)
    throw Error(Status::Invalid, path, "has no <Collection>", "export it again");
  std::map<double, Frame> byTime;
  for (const pugi::xml_node set : collection.children("DataSet")) {
    const std::string name = set.attribute("file").value();
    if (name.empty())
      throw Error(Status::Invalid, path, "a <DataSet> names no file", "export it again");
    const char* text = set.attribute("timestep").value();
    double time = 0;
    const std::string_view digits(text);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), time);
    if (!digits.empty() &&
        (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(time)))
      throw Error(Status::Invalid, path, fmt::format("'{}' is no time", text), "export it again");
    const std::string part = pathWithin(path, name);
    Frame& frame = byTime[time];
    frame.time = time;
    frame.inputs.push_back(part);
  }
  if (byTime.empty())
    throw Error(Status::Invalid, path, "the collection is empty", "export it again");
  std::vector<Frame> frames;
  for (auto& [time, frame] : byTime)
    frames.push_back(std::move(frame));
  return frames;
}

std::vector<Frame> framesOfFile(const std::string& path, Report& report, Progress& progress) {
  const MappedFile file(path);
  const Format& format = formatOf(sniffFormat(file.bytes(), path));
  if (!can(format, FormatUse::ReadSteps))
    throw Error(Status::Usage, "`frames`", path + " is no sequence",
                "name a .pvd file, a pattern such as 'frame_*.vtu' or a file of several steps (" +
                    endingList(FormatUse::ReadSteps) + ")");
  const std::vector<double> times = format.readTimes(file.source(), report, progress);
  if (times.empty())
    throw Error(Status::Invalid, path, "has no time steps", "leave `frames` out");
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < times.size(); ++i)
    frames.push_back({{path}, static_cast<int>(i), times[i]});
  return frames;
}

std::vector<Frame> chosen(std::vector<Frame> frames, const FrameRange& range) {
  const std::size_t last = range.last == 0 ? frames.size() : range.last;
  if (range.first < 1 || range.first > last || range.stride < 1)
    throw Error(Status::Usage, "`frames`", "the first frame comes after the last",
                "give FIRST:LAST, counted from 1");
  if (last > frames.size())
    throw Error(Status::Usage, "`frames`", fmt::format("there is no frame {}", last),
                fmt::format("there are {}", frames.size()));
  std::vector<Frame> some;
  for (std::size_t i = range.first; i <= last; i += range.stride)
    some.push_back(std::move(frames[i - 1]));
  return some;
}

} // namespace

bool isNumbered(const std::vector<std::string>& paths) {
  if (paths.size() < 2)
    return false;
  const NumberedPath first(paths.front());
  std::set<unsigned long long> numbers;
  for (const std::string& path : paths) {
    const NumberedPath name(path);
    if (!name.number || name.before != first.before || name.after != first.after ||
        name.extension != first.extension || !numbers.insert(*name.number).second)
      return false;
  }
  return true;
}

std::vector<Frame> findFrames(const std::vector<std::string>& inputs,
                              const std::optional<FrameRange>& range, bool allowGaps,
                              Report& report, Progress& progress) {
  const auto isSequence = [](const std::string& path) {
    return isPattern(path) || isCollection(path);
  };
  const bool numbered = isNumbered(inputs);
  if (!range && !numbered && std::none_of(inputs.begin(), inputs.end(), isSequence))
    return {};
  if (inputs.size() != 1 && !numbered)
    throw Error(Status::Usage, "", "a sequence must be the only input",
                "quote the pattern: 'frame_*.vtu'");
  std::vector<Frame> frames;
  if (numbered)
    frames = framesByNumber(inputs, inputs.front(), allowGaps);
  else if (isPattern(inputs.front()))
    frames = framesByNumber(filesLike(inputs.front()), inputs.front(), allowGaps);
  else if (isCollection(inputs.front()))
    frames = framesOfCollection(inputs.front());
  else
    frames = framesOfFile(inputs.front(), report, progress);
  return range ? chosen(std::move(frames), *range) : frames;
}

bool isPattern(const std::string& path) {
  return path.find_first_of("*?") != std::string::npos && !exists(path);
}

std::vector<std::string> filesOf(const std::vector<std::string>& inputs) {
  std::vector<std::string> files;
  for (const std::string& input : inputs) {
    if (isCollection(input))
      throw Error(Status::Usage, input, "is a collection of times, not of parts of one volume",
                  "name the files of one time");
    if (!isPattern(input)) {
      files.push_back(input);
      continue;
    }
    std::vector<std::string> found = filesLike(input);
    std::sort(found.begin(), found.end(), [](const std::string& a, const std::string& b) {
      return std::make_pair(NumberedPath(a).number, a) < std::make_pair(NumberedPath(b).number, b);
    });
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

std::string frameName(const std::string& output, std::size_t number, std::size_t count) {
  fs::path path(output);
  const std::string extension = path.extension().string();
  const std::size_t digits = std::max<std::size_t>(4, std::to_string(count).size());
  path.replace_extension();
  return fmt::format("{}.{:0{}}{}", path.string(), number, digits, extension);
}

} // namespace tetvdb
