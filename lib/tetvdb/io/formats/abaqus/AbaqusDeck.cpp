// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/abaqus/AbaqusDeck.h"

#include "tetvdb/core/Letters.h"
#include "tetvdb/io/source/PathWithin.h"

#include <charconv>
#include <cmath>

namespace tetvdb {
namespace {

/// Removes the text up to the next comma from `rest` and returns it.
std::string_view cutField(std::string_view& rest) {
  const std::size_t comma = rest.find(',');
  const std::string_view field = trimmed(rest.substr(0, comma));
  rest = comma == rest.npos ? std::string_view() : rest.substr(comma + 1);
  return field;
}

std::string capitals(std::string_view text) {
  std::string result;
  for (const char c : text)
    if (static_cast<unsigned char>(c) > ' ')
      result += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return result;
}

bool isKeyword(std::string_view line) {
  return !line.empty() && line[0] == '*';
}

/// Removes the keyword from its line.
std::string keywordOf(std::string_view& line) {
  line.remove_prefix(1);
  return capitals(cutField(line));
}

} // namespace

std::string abaqusName(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
    return std::string(text.substr(1, text.size() - 2));
  return capitals(text);
}

// Moves to the next line that is no comment; false at the end.
bool AbaqusDeck::readLine() {
  if (isAhead_) {
    isAhead_ = false;
    return true;
  }
  for (;;) {
    for (; file().remaining() == 0; open_.pop_back())
      if (open_.size() == 1)
        return false;
    line_.file = open_.back();
    line_.position = file().position();
    line_.text = file().line();
    if (line_.text.substr(0, 2) == "**")
      continue;
    std::string_view rest = line_.text;
    if (!isKeyword(rest) || keywordOf(rest) != "INCLUDE")
      return true;
    at_ = line_;
    const Parameters parameters = readParameters(line_.text, rest);
    const auto input = parameters.find("INPUT");
    if (input == parameters.end())
      fail("*INCLUDE names no file", "write *INCLUDE, INPUT=FILE");
    include(input->second);
  }
}

void AbaqusDeck::include(const std::string& name) {
  if (open_.size() > kDeepestInclusion || included_.size() == kMostInclusions)
    fail("too many files include one another", "put the data into one file");
  const bool quoted = name.size() >= 2 && name.front() == '"' && name.back() == '"';
  const MappedFile& file =
      included_.emplace_back(pathWithin(path_, quoted ? name.substr(1, name.size() - 2) : name));
  bytes_ += file.bytes().size();
  open_.push_back(files_.size());
  files_.emplace_back(file.source());
}

// Of a keyword's line without the keyword. A line that ends with a comma goes on in the next one.
AbaqusDeck::Parameters AbaqusDeck::readParameters(std::string_view line, std::string_view rest) {
  Parameters parameters;
  for (;; rest = line) {
    while (!rest.empty()) {
      const std::string_view field = cutField(rest);
      if (field.empty())
        continue;
      const std::size_t equals = field.find('=');
      parameters[capitals(field.substr(0, equals))] =
          equals == field.npos ? std::string() : std::string(trimmed(field.substr(equals + 1)));
    }
    if (trimmed(line).empty() || trimmed(line).back() != ',' || file().remaining() == 0)
      return parameters;
    line = file().line();
  }
}

bool AbaqusDeck::nextKeyword() {
  do {
    if (!readLine())
      return false;
  } while (!isKeyword(line_.text));
  at_ = line_;
  std::string_view rest = line_.text;
  keyword_ = keywordOf(rest);
  parameters_ = readParameters(line_.text, rest);
  fields_ = {};
  return true;
}

const std::string* AbaqusDeck::parameter(const std::string& name) const {
  const auto found = parameters_.find(name);
  return found == parameters_.end() ? nullptr : &found->second;
}

bool AbaqusDeck::nextLine() {
  do {
    if (!readLine())
      return false;
    isAhead_ = isKeyword(line_.text);
    if (isAhead_)
      return false;
    fields_ = trimmed(line_.text);
  } while (fields_.empty());
  at_ = line_;
  continues_ = fields_.back() == ',';
  if (continues_)
    fields_.remove_suffix(1);
  return true;
}

bool AbaqusDeck::nextField(std::string_view& field) {
  if (fields_.empty())
    return false;
  field = cutField(fields_);
  return true;
}

std::int64_t AbaqusDeck::integer(std::string_view field) const {
  std::int64_t value = 0;
  const char* end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(field.data(), end, value);
  if (error == std::errc() && stop == end)
    return value;
  const double number = real(field);
  if (number != std::floor(number) || std::abs(number) > 9e15)
    fail("expected a whole number, found '" + std::string(field.substr(0, 40)) + "'");
  return static_cast<std::int64_t>(number);
}

double AbaqusDeck::real(std::string_view field) const {
  if (field.empty())
    return 0; // by the format's rule
  double value = 0;
  const char* end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(field.data(), end, value);
  if (error != std::errc() || stop != end) {
    NumberParser parser(field, "");
    if (!parser.tryReal(value) || !parser.atEnd())
      value = NAN;
  }
  if (!std::isfinite(value)) {
    std::string shown;
    for (const char c : field.substr(0, 40))
      shown += c < ' ' || c > '~' ? '?' : c;
    fail("expected a finite number, found '" + shown + "'");
  }
  return value;
}

} // namespace tetvdb
