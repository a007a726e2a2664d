// SPDX-License-Identifier: Apache-2.0
//
// Parses numbers and words of a text, fast, with line numbers for messages.
//
//   tetvdb::NumberParser in(source, '#');             // '#' begins a comment
//   const std::size_t n = in.count("vertices", 6);    // refused where the file cannot hold them
//   for (std::size_t i = 0; i < n; ++i) points.push_back({in.real(), in.real(), in.real()});
//
// A number may have a leading '+' and an exponent with E, D or Q (Fortran); the locale is not used.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/Source.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace tetvdb {

/// A cursor in a text. White space (including line breaks, '\0' and other control characters) and
/// comments are skipped before every number and word. Methods throw Error(Invalid) with
/// "path:line". Not thread-safe; several parsers may share one text.
class NumberParser {
public:
  /// Parses source.bytes from byte `begin` on. `comment`: the character from which the rest of a
  /// line is ignored, 0 for none. The source's bytes must outlive the parser.
  explicit NumberParser(const Source& source, char comment = 0, std::size_t begin = 0)
      : NumberParser(source.bytes, source.path, comment, begin) {}
  NumberParser(std::string_view text, std::string path, char comment = 0, std::size_t begin = 0)
      : begin_(text.data()), end_(text.data() + text.size()),
        at_(begin_ + std::min(begin, text.size())), path_(std::move(path)), comment_(comment) {}

  /// Byte offset of the cursor within the text.
  std::size_t position() const { return static_cast<std::size_t>(at_ - begin_); }
  void seek(std::size_t position) {
    at_ = begin_ + std::min(position, static_cast<std::size_t>(end_ - begin_));
  }
  std::size_t remaining() const { return static_cast<std::size_t>(end_ - at_); }
  /// Whether white space or the end follows: whether the word has been read completely.
  bool atWordEnd() const { return at_ == end_ || static_cast<unsigned char>(*at_) <= ' '; }

  /// Skips white space and comments.
  void skipSpace() {
    for (; at_ != end_; ++at_) {
      if (static_cast<unsigned char>(*at_) <= ' ')
        continue;
      if (comment_ == 0 || *at_ != comment_)
        return;
      while (at_ != end_ && *at_ != '\n' && *at_ != '\r')
        ++at_;
      if (at_ == end_)
        return;
    }
  }
  /// Skips white space and comments; returns whether nothing else is left.
  bool atEnd() {
    skipSpace();
    return at_ == end_;
  }

  /// The next word, up to white space (or a comment); empty at the end.
  std::string_view word() {
    skipSpace();
    const char* start = at_;
    while (at_ != end_ && static_cast<unsigned char>(*at_) > ' ' &&
           (comment_ == 0 || *at_ != comment_))
      ++at_;
    return {start, static_cast<std::size_t>(at_ - start)};
  }
  /// The next word, without consuming it.
  std::string_view peekWord() {
    skipSpace();
    const char* start = at_;
    const std::string_view found = word();
    at_ = start;
    return found;
  }
  /// The rest of the cursor's line without its break (\n, \r or \r\n), comments included; the
  /// cursor moves to the next line. Empty at the end.
  std::string_view line() {
    const char* start = at_;
    while (at_ != end_ && *at_ != '\n' && *at_ != '\r')
      ++at_;
    const std::string_view found{start, static_cast<std::size_t>(at_ - start)};
    if (at_ != end_ && *at_++ == '\r' && at_ != end_ && *at_ == '\n')
      ++at_;
    return found;
  }

  /// The next number; throws if there is none or it is not finite. Numbers too small for a double
  /// are 0.
  double real() {
    const char* start = at_;
    double value = 0;
    if (!tryReal(value))
      failNumber("a number");
    if (!std::isfinite(value)) {
      at_ = start;
      failNumber("a finite number");
    }
    return value;
  }
  /// As real(), but accepts nan and inf: for data arrays.
  double value() {
    double value = 0;
    if (!tryReal(value))
      failNumber("a number");
    return value;
  }
  /// The next integer; throws if there is none. "3.0" is not an integer: see realInteger().
  std::int64_t integer() {
    std::int64_t value = 0;
    if (!tryInteger(value))
      failNumber("a whole number");
    return value;
  }
  /// An integer that may be written as 3.0 or 3e0.
  std::int64_t realInteger() {
    std::int64_t value = 0;
    if (tryInteger(value))
      return value;
    const char* start = at_;
    const double number = real();
    if (number != std::floor(number) || std::abs(number) > 9e15) {
      at_ = start;
      failNumber("a whole number");
    }
    return static_cast<std::int64_t>(number);
  }
  /// A count of elements, each of which has at least `bytesEach` bytes of the remaining text:
  /// throws if it is negative or exceeds the text. Safe for reserve().
  std::size_t count(std::string_view things, std::size_t bytesEach = 2) {
    const std::int64_t n = integer();
    checkCount(n, things, bytesEach);
    return static_cast<std::size_t>(n);
  }
  /// The check of count() for a number from another source. The last element needs no separator
  /// after it.
  void checkCount(std::int64_t n, std::string_view things, std::size_t bytesEach = 2) const {
    if (n < 0)
      fail("negative number of " + std::string(things));
    if (static_cast<std::uint64_t>(n) > (remaining() + bytesEach) / bytesEach)
      fail(std::to_string(n) + " " + std::string(things) +
               " are declared, more than the file holds",
           kCut);
  }

  /// Returns false, with the cursor after the white space, if no number follows.
  bool tryReal(double& value) {
    skipSpace();
    const char* start = at_ != end_ && *at_ == '+' ? at_ + 1 : at_;
    if (start != at_ && start != end_ && *start == '-')
      return false;
    const auto [stop, error] = std::from_chars(start, end_, value);
    if (error == std::errc() && endsNumber(stop)) {
      at_ = stop;
      return true;
    }
    return tryUnusualReal(start, value);
  }
  bool tryInteger(std::int64_t& value) {
    skipSpace();
    const char* start = at_ != end_ && *at_ == '+' ? at_ + 1 : at_;
    if (start != at_ && start != end_ && *start == '-')
      return false;
    const auto [stop, error] = std::from_chars(start, end_, value);
    if (error != std::errc() || !endsNumber(stop))
      return false;
    at_ = stop;
    return true;
  }

  /// Line of the cursor, from 1. Linear in the position: for messages only.
  std::size_t lineNumber() const {
    std::size_t line = 1;
    for (const char* c = begin_; c < at_; ++c)
      if (*c == '\n' || (*c == '\r' && (c + 1 == end_ || c[1] != '\n')))
        ++line;
    return line;
  }
  /// "path:line".
  std::string where() const { return path_ + ":" + std::to_string(lineNumber()); }
  const std::string& path() const { return path_; }

  [[noreturn]] void fail(std::string_view what, std::string_view advice = {}) const {
    throw Error(Status::Invalid, where(), what, advice);
  }
  /// "expected `wanted`, found 'word'", or that the file ends.
  [[noreturn]] void failNumber(std::string_view wanted) {
    skipSpace();
    if (at_ == end_)
      fail("the file ends where " + std::string(wanted) + " is expected",
           "it is cut off; export it again");
    std::string found;
    for (char c : peekWord().substr(0, 40)) // a message is one line of readable characters
      found +=
          static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e ? '?' : c;
    fail("expected " + std::string(wanted) + ", found '" + found + "'");
  }

private:
  // A number ends at white space, punctuation such as ',' or '<', or the end.
  bool endsNumber(const char* at) const {
    if (at == end_)
      return true;
    const char c = *at;
    return !((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
             c == '.' || c == '+' || c == '-' || c == '_');
  }

  // Fortran exponents (1.5D+03, 1.5-103) and numbers out of a double's range.
  bool tryUnusualReal(const char* start, double& value) {
    char text[64] = {};
    std::size_t length = 0;
    const char* stop = start;
    for (; !endsNumber(stop) && length + 2 < sizeof text; ++stop) {
      const char before = stop == start ? 'e' : stop[-1];
      const bool digitBefore = (before >= '0' && before <= '9') || before == '.';
      const char c = *stop;
      const bool mark = c == 'd' || c == 'D' || c == 'q' || c == 'Q';
      if (digitBefore && (c == '+' || c == '-'))
        text[length++] = 'e';
      text[length++] = digitBefore && mark ? 'e' : c;
    }
    // A longer number may only exceed the range.
    const bool fits = endsNumber(stop);
    const char* first = fits ? text : start;
    const char* last = fits ? text + length : end_;
    double number = 0;
    const auto [end, error] = std::from_chars(first, last, number);
    if (error != std::errc() && error != std::errc::result_out_of_range)
      return false;
    if (fits ? end != last : !endsNumber(end))
      return false;
    if (error == std::errc::result_out_of_range) {
      const std::string_view digits(first, static_cast<std::size_t>(end - first));
      const bool small = digits.find("e-") != digits.npos || digits.find("E-") != digits.npos ||
                         digits.substr(digits[0] == '-' ? 1 : 0, 2) == "0.";
      number = small ? 0 : std::numeric_limits<double>::infinity();
    }
    value = number;
    at_ = fits ? stop : end;
    return true;
  }

  const char* begin_;
  const char* end_;
  const char* at_;
  std::string path_;
  char comment_;
};

} // namespace tetvdb
