// SPDX-License-Identifier: Apache-2.0
//
// The format: EnSight User Manual, chapter 11, "EnSight Gold Casefile Format".
#include "tetvdb/io/formats/ensight/EnsightCase.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/PathWithin.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

namespace tetvdb::ensight {
namespace {

class CaseParser {
public:
  explicit CaseParser(const Source& source) : in_(source) {}

  Case parse() {
    std::string section;
    for (std::string_view line; nextLine(line);) {
      const std::size_t colon = line.find(':');
      if (colon == line.npos) {
        if (!continueNumbers(line))
          section = lowerCase(line);
        continue;
      }
      const std::string key = lowerCase(trimmed(line.substr(0, colon)));
      readEntry(section, key, trimmed(line.substr(colon + 1)));
    }
    if (!isGold_)
      in_.fail("has no line 'type: ensight gold'", kExport);
    finishTimeSets();
    if (case_.geometry.name.empty())
      in_.fail("names no file of the geometry ('model:')", kExport);
    check(case_.geometry);
    for (const Variable& variable : case_.variables)
      check(variable.file);
    return std::move(case_);
  }

private:
  /// The next line without comment that is not empty.
  bool nextLine(std::string_view& line) {
    do {
      if (in_.remaining() == 0)
        return false;
      line = in_.line();
      line = trimmed(line.substr(0, line.find('#')));
    } while (line.empty());
    return true;
  }

  void readEntry(const std::string& section, const std::string& key, std::string_view value) {
    numbers_ = nullptr;
    fileNumbers_ = nullptr;
    if (section == "format")
      readFormat(key, lowerCase(value));
    else if (section == "geometry" && key == "model")
      case_.geometry = pattern(value, false);
    else if (section == "geometry" && (key == "match" || key == "boundary" || key == "measured"))
      return;
    else if (section == "variable")
      readVariable(key, value);
    else if (section == "time")
      readTime(key, value);
    else if (section == "file")
      readFileSet(key, value);
  }

  void readFormat(const std::string& key, const std::string& value) {
    if (key != "type")
      return;
    if (value != "ensight gold")
      in_.fail("is of the type '" + value.substr(0, 40) + "', which is not read",
               "write it as EnSight Gold");
    isGold_ = true;
  }

  /// "[ts] [fs] name"; with `described` "[ts] [fs] description name".
  FilePattern pattern(std::string_view value, bool described, std::string* name = nullptr) const {
    std::vector<std::string_view> words;
    for (std::size_t at = 0; at < value.size();) {
      std::size_t end = at;
      const bool quoted = value[at] == '"';
      if (quoted)
        end = std::min(value.find('"', at + 1), value.size());
      else
        while (end < value.size() && static_cast<unsigned char>(value[end]) > ' ')
          ++end;
      const std::size_t begin = quoted ? at + 1 : at;
      if (end > begin)
        words.push_back(value.substr(begin, end - begin));
      at = end + 1;
    }
    const auto number = [&](std::size_t i, std::int64_t& n) {
      if (i + 1 + (described ? 1 : 0) >= words.size())
        return false;
      NumberParser in(words[i], in_.path());
      return in.tryInteger(n) && in.atEnd();
    };
    FilePattern found;
    std::size_t next = 0;
    if (number(0, found.timeSet)) {
      ++next;
      if (number(1, found.fileSet))
        ++next;
    }
    if (described && next < words.size()) {
      if (name != nullptr)
        *name = std::string(words[next]);
      ++next;
    }
    if (next >= words.size())
      in_.fail("an entry names no file", kExport);
    found.name = std::string(words[next]);
    if (found.timeSet < 0 && found.name.find('*') != std::string::npos)
      found.timeSet = 1;
    return found;
  }

  void readVariable(const std::string& key, std::string_view value) {
    static constexpr std::pair<std::string_view, std::uint32_t> kinds[] = {
        {"scalar", 1}, {"vector", 3}, {"tensor symm", 6}, {"tensor asym", 9}};
    for (const auto& [kind, components] : kinds)
      for (const bool onElements : {false, true})
        if (key == std::string(kind) + (onElements ? " per element" : " per node")) {
          Variable variable;
          variable.onElements = onElements;
          variable.components = components;
          variable.file = pattern(value, true, &variable.name);
          case_.variables.push_back(std::move(variable));
          return;
        }
    case_.otherVariables.push_back(key);
  }

  void readTime(const std::string& key, std::string_view value) {
    NumberParser in(value, in_.path());
    if (key == "time set") {
      sets_.emplace_back();
      sets_.back().set.id = integer(in, "the number of a time set");
      return;
    }
    if (sets_.empty())
      in_.fail("'" + key + "' stands before 'time set'", kExport);
    Unfinished& last = sets_.back();
    if (key == "number of steps")
      last.steps = integer(in, "a number of steps");
    else if (key == "filename start number")
      last.start = integer(in, "a file's number");
    else if (key == "filename increment")
      last.increment = integer(in, "a number");
    else if (key == "time values")
      readNumbers(in, numbers_ = &last.set.times);
    else if (key == "filename numbers")
      readNumbers(in, fileNumbers_ = &last.set.fileNumbers);
    else if (key.find("file") != key.npos)
      in_.fail("takes times or numbers from other files, which is not read", kExport);
  }
  void readFileSet(const std::string& key, std::string_view value) {
    NumberParser in(value, in_.path());
    std::vector<FileSet>& sets = case_.fileSets;
    if (key == "file set") {
      sets.emplace_back();
      sets.back().id = integer(in, "the number of a file set");
      return;
    }
    if (sets.empty())
      in_.fail("'" + key + "' stands before 'file set'", kExport);
    std::vector<FileSet::File>& files = sets.back().files;
    if (key == "filename index")
      files.push_back({integer(in, "a file's number"), 0});
    if (key != "number of steps")
      return;
    if (files.empty() || !files.back().index)
      files.emplace_back();
    files.back().steps = integer(in, "a number of steps");
    if (files.back().steps < 1)
      in_.fail("a file holds no steps", kExport);
  }

  std::int64_t integer(NumberParser& in, const char* what) const {
    std::int64_t n = 0;
    if (!in.tryInteger(n))
      in_.fail(std::string("expected ") + what, kExport);
    return n;
  }
  template <class T>
  bool readNumbers(NumberParser& in, std::vector<T>* numbers) const {
    const std::size_t before = numbers->size();
    double number = 0;
    while (in.tryReal(number)) {
      if (!std::isfinite(number) || std::abs(number) > 1e18)
        in_.fail("a time is not finite", kExport);
      numbers->push_back(static_cast<T>(number));
    }
    return in.atEnd() && numbers->size() > before;
  }
  /// Lists of numbers may continue on several lines.
  bool continueNumbers(std::string_view line) const {
    NumberParser in(line, in_.path());
    if (numbers_ != nullptr)
      return readNumbers(in, numbers_);
    return fileNumbers_ != nullptr && readNumbers(in, fileNumbers_);
  }

  void finishTimeSets() {
    for (Unfinished& one : sets_) {
      TimeSet& set = one.set;
      if (set.times.empty() || one.steps != static_cast<std::int64_t>(set.times.size()))
        in_.fail("time set " + std::to_string(set.id) + " has " + std::to_string(set.times.size()) +
                     " times for " + std::to_string(one.steps) + " steps",
                 kExport);
      if (set.fileNumbers.empty())
        for (std::size_t i = 0; i < set.times.size(); ++i)
          set.fileNumbers.push_back(static_cast<std::int64_t>(
              static_cast<std::uint64_t>(one.start) +
              static_cast<std::uint64_t>(one.increment) * static_cast<std::uint64_t>(i)));
      if (set.fileNumbers.size() != set.times.size())
        in_.fail("time set " + std::to_string(set.id) + " has " +
                     std::to_string(set.fileNumbers.size()) + " file numbers for " +
                     std::to_string(set.times.size()) + " times",
                 kExport);
      case_.timeSets.push_back(std::move(set));
    }
  }
  void check(const FilePattern& pattern) const {
    const bool known = std::any_of(case_.timeSets.begin(), case_.timeSets.end(),
                                   [&](const TimeSet& set) { return set.id == pattern.timeSet; });
    if (pattern.timeSet >= 0 && !known)
      in_.fail("'" + pattern.name + "' belongs to time set " + std::to_string(pattern.timeSet) +
                   ", which does not exist",
               kExport);
    const auto& sets = case_.fileSets;
    if (pattern.fileSet >= 0 && std::none_of(sets.begin(), sets.end(), [&](const FileSet& set) {
          return set.id == pattern.fileSet;
        }))
      in_.fail("'" + pattern.name + "' belongs to file set " + std::to_string(pattern.fileSet) +
                   ", which does not exist",
               kExport);
  }

  struct Unfinished {
    TimeSet set;
    std::int64_t steps = 0, start = 0, increment = 1;
  };

  NumberParser in_;
  bool isGold_ = false;
  std::vector<Unfinished> sets_;
  std::vector<double>* numbers_ = nullptr;           ///< list that the next line may continue
  std::vector<std::int64_t>* fileNumbers_ = nullptr; ///< likewise
  Case case_;
};

} // namespace

std::vector<double> Case::times() const {
  std::set<std::int64_t> used{geometry.timeSet};
  for (const Variable& variable : variables)
    used.insert(variable.file.timeSet);
  std::set<double> all;
  for (const TimeSet& set : timeSets)
    if (used.count(set.id) != 0)
      all.insert(set.times.begin(), set.times.end());
  return {all.begin(), all.end()};
}

StepPlace Case::placeOf(const FilePattern& pattern, std::size_t step,
                        const std::string& path) const {
  std::optional<std::int64_t> number; // in the file's name
  std::size_t chosen = 0;             // step of the time set
  const auto times = std::find_if(timeSets.begin(), timeSets.end(),
                                  [&](const TimeSet& one) { return one.id == pattern.timeSet; });
  if (times != timeSets.end()) {
    const double time = this->times().at(step);
    for (std::size_t i = 0; i < times->times.size(); ++i)
      if (times->times[i] <= time && times->times[i] >= times->times[chosen])
        chosen = i;
    number = times->fileNumbers[chosen];
  }
  StepPlace place;
  const auto files = std::find_if(fileSets.begin(), fileSets.end(),
                                  [&](const FileSet& one) { return one.id == pattern.fileSet; });
  if (files != fileSets.end()) {
    auto file = files->files.begin();
    for (; file != files->files.end() && chosen >= static_cast<std::uint64_t>(file->steps); ++file)
      chosen -= static_cast<std::size_t>(file->steps);
    if (file == files->files.end())
      throw Error(Status::Invalid, path,
                  "file set " + std::to_string(files->id) + " has fewer steps than time set " +
                      std::to_string(pattern.timeSet),
                  kExport);
    place.number = chosen;
    number = file->index;
  }
  std::string name = pattern.name;
  if (const std::size_t star = name.find('*'); star != name.npos && number) {
    const std::size_t end = std::min(name.find_first_not_of('*', star), name.size());
    std::string digits = std::to_string(*number);
    if (digits.size() < end - star)
      digits.insert(0, end - star - digits.size(), '0');
    name.replace(star, end - star, digits);
  }
  place.path = pathWithin(path, name);
  return place;
}

Case parseCase(const Source& source) {
  return CaseParser(source).parse();
}

} // namespace tetvdb::ensight
