// SPDX-License-Identifier: Apache-2.0
//
// The format: MSC Nastran Quick Reference Guide, "Format of Bulk Data Entries".
#include "tetvdb/io/formats/nastran/NastranDeck.h"

#include "tetvdb/core/Letters.h"
#include "tetvdb/io/source/Advice.h"

#include <algorithm>

namespace tetvdb {
namespace {

constexpr std::size_t kName = 8; ///< characters of the first field, and of continuation fields
constexpr std::size_t kSmall = 8, kLarge = 16; ///< characters of a field
constexpr std::size_t kMaxFields = 1000;
constexpr std::size_t kInclude = 7;    ///< characters of the word
constexpr std::size_t kMaxName = 4096; ///< of a file

/// Spaces up to the next multiple of 8 for each tab.
std::string expandedTabs(std::string_view line) {
  std::string result;
  for (const char c : line)
    if (c == '\t')
      result.append(kSmall - result.size() % kSmall, ' ');
    else
      result += c;
  return result;
}

bool isBeginBulk(std::string_view line) {
  NumberParser words(line, "");
  return lowerCase(words.word()) == "begin" && lowerCase(words.word()).substr(0, 4) == "bulk";
}

} // namespace

std::optional<double> nastranReal(std::string_view text) {
  // "1.5-3", "1.5+3" and "1.5D-3" stand for 1.5e-3, 1.5e3 and 1.5e-3.
  char plain[64];
  std::size_t n = 0;
  bool hasExponent = false;
  if (text.empty() || text.size() > sizeof plain / 2)
    return {};
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool isLetter = c == 'e' || c == 'E' || c == 'd' || c == 'D';
    if (!hasExponent && i > 0 && (isLetter || c == '+' || c == '-')) {
      plain[n++] = 'e';
      hasExponent = true;
      if (isLetter)
        continue;
    }
    plain[n++] = c;
  }
  NumberParser number({plain, n}, "");
  double value = 0;
  if (!number.tryReal(value) || !number.atEnd() || !std::isfinite(value))
    return {};
  return value;
}

NastranDeck::NastranDeck(const Source& source) : in_(source) {
  while (readLine())
    if (isBeginBulk(line_)) {
      hasLine_ = readLine();
      return;
    }
  in_.seek(0);
  hasLine_ = readLine();
}

bool NastranDeck::readLine() {
  while (in_.remaining() > 0) {
    const std::string_view whole = in_.line();
    line_ = whole.substr(0, whole.find('$'));
    if (!trimmed(line_).empty())
      return true;
  }
  return false;
}

bool NastranDeck::isContinuation() const {
  if (line_.front() == '+' || line_.front() == '*' || line_.front() == ',')
    return true;
  const std::size_t tab = line_.find('\t');
  const std::string_view first = line_.substr(0, std::min({line_.find(','), tab, kName}));
  return trimmed(first).empty();
}

bool NastranDeck::next() {
  expanded_.clear();
  fields_.clear();
  name_.clear();
  while (hasLine_ && isContinuation()) // of what is no entry
    hasLine_ = readLine();
  if (!hasLine_)
    return false;
  if (lowerCase(trimmed(line_).substr(0, kInclude)) == "include") {
    readInclude();
    return true;
  }
  addFields(true);
  if (name_ == "ENDDATA") {
    hasLine_ = false;
    return false;
  }
  for (hasLine_ = readLine(); hasLine_ && isContinuation(); hasLine_ = readLine())
    if (fields_.size() < kMaxFields)
      addFields(false);
  return true;
}

// A name in quotes may go on in the next lines.
void NastranDeck::readInclude() {
  name_ = "INCLUDE";
  std::string text(trimmed(trimmed(line_).substr(kInclude)));
  hasLine_ = readLine();
  const char quote = text.empty() ? ' ' : text.front();
  if (quote == '\'' || quote == '"') {
    text.erase(0, 1);
    while (text.find(quote) == text.npos && hasLine_ && text.size() < kMaxName) {
      text += trimmed(line_);
      hasLine_ = readLine();
    }
    text.resize(std::min(text.find(quote), text.size()));
  }
  includedFile_ = text;
}

void NastranDeck::addFields(bool isFirst) {
  std::string_view line = line_;
  std::string_view first;
  std::size_t added = 0, all = 8;
  if (const std::size_t comma = line.find(','); comma != line.npos) {
    first = trimmed(line.substr(0, comma));
    const bool isLarge = first.find('*') != first.npos;
    all = isLarge ? 4 : 8;
    std::size_t at = comma + 1;
    while (added < all && at <= line.size()) {
      const std::size_t end = std::min(line.find(',', at), line.size());
      fields_.push_back(trimmed(line.substr(at, end - at)));
      ++added;
      at = end + 1;
    }
  } else {
    if (line.find('\t') != line.npos)
      line = expanded_.emplace_back(expandedTabs(line));
    first = trimmed(line.substr(0, std::min(line.size(), kName)));
    const bool isLarge = first.find('*') != first.npos;
    const std::size_t width = isLarge ? kLarge : kSmall;
    all = isLarge ? 4 : 8;
    for (std::size_t at = kName; added < all && at < line.size(); at += width, ++added)
      fields_.push_back(trimmed(line.substr(at, width)));
  }
  fields_.resize(fields_.size() + all - added);
  if (isFirst) {
    name_ = first.substr(0, first.find('*'));
    std::transform(name_.begin(), name_.end(), name_.begin(),
                   [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
  }
}

std::optional<std::int64_t> NastranDeck::integer(std::size_t number) const {
  const std::string_view text = field(number);
  if (text.empty())
    return {};
  NumberParser parser(text, "");
  std::int64_t value = 0;
  if (!parser.tryInteger(value) || !parser.atEnd())
    fail("field " + std::to_string(number + 1) + " is '" + std::string(text.substr(0, 40)) +
             "' in place of an integer",
         kExport);
  return value;
}

double NastranDeck::real(std::size_t number) const {
  const std::string_view text = field(number);
  if (text.empty())
    return 0;
  const std::optional<double> value = nastranReal(text);
  if (!value)
    fail("field " + std::to_string(number + 1) + " is '" + std::string(text.substr(0, 40)) +
             "' in place of a number",
         kExport);
  return *value;
}

} // namespace tetvdb
