// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/abaqus/AbaqusDeck.h"

#include "tetvdb/core/Letters.h"

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

} // namespace

std::string abaqusName(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
    return std::string(text.substr(1, text.size() - 2));
  return capitals(text);
}

bool AbaqusDeck::nextKeyword() {
  std::string_view line;
  do {
    if (in_.remaining() == 0)
      return false;
    at_.seek(in_.position());
    line = in_.line();
  } while (line.empty() || line[0] != '*' || line.substr(0, 2) == "**");
  line.remove_prefix(1);
  keyword_ = capitals(cutField(line));
  parameters_.clear();
  line_ = {};
  for (;;) {
    const bool goesOn = !trimmed(line).empty() && trimmed(line).back() == ',';
    while (!line.empty()) {
      const std::string_view field = cutField(line);
      if (field.empty())
        continue;
      const std::size_t equals = field.find('=');
      parameters_[capitals(field.substr(0, equals))] =
          equals == field.npos ? std::string() : std::string(trimmed(field.substr(equals + 1)));
    }
    if (!goesOn || in_.remaining() == 0)
      return true;
    line = in_.line();
  }
}

const std::string* AbaqusDeck::parameter(const std::string& name) const {
  const auto found = parameters_.find(name);
  return found == parameters_.end() ? nullptr : &found->second;
}

bool AbaqusDeck::nextLine() {
  for (;;) {
    if (in_.remaining() == 0)
      return false;
    const std::size_t start = in_.position();
    const std::string_view line = in_.line();
    if (line.substr(0, 2) == "**")
      continue;
    if (!line.empty() && line[0] == '*') {
      in_.seek(start);
      return false;
    }
    line_ = trimmed(line);
    if (line_.empty())
      continue;
    at_.seek(start);
    continues_ = line_.back() == ',';
    if (continues_)
      line_.remove_suffix(1);
    return true;
  }
}

bool AbaqusDeck::nextField(std::string_view& field) {
  if (line_.empty())
    return false;
  field = cutField(line_);
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
