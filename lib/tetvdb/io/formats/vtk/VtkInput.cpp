// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/VtkInput.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/source/Advice.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace tetvdb::vtk {
namespace {

// Names contain %20 for a space, and so on.
std::string percentDecoded(std::string_view name) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (name[i] == '%' && i + 2 < name.size() && digit(name[i + 1]) >= 0 &&
        digit(name[i + 2]) >= 0) {
      out += static_cast<char>(digit(name[i + 1]) * 16 + digit(name[i + 2]));
      i += 2;
    } else {
      out += name[i];
    }
  }
  return out;
}

bool machineIsLittleEndian() {
  const std::uint16_t one = 1;
  return *reinterpret_cast<const char*>(&one) == 1;
}

} // namespace

std::string keywordOf(std::string_view word) {
  return lowerCase(word.substr(0, 64));
}

std::string readable(std::string_view word) {
  std::string out(word.substr(0, 40));
  for (char& c : out)
    if (c < 0x20 || c > 0x7e)
      c = '?';
  return out;
}

std::string VtkInput::where() const {
  return binary_ ? source_.path + " at byte " + std::to_string(in_.position()) : in_.where();
}

void VtkInput::fail(const std::string& what, const char* advice) const {
  throw Error(Status::Invalid, where(), what, advice);
}

std::size_t VtkInput::count() {
  std::int64_t n = 0;
  if (!in_.tryInteger(n) || n < 0)
    fail("expected a count, found '" + readable(in_.peekWord()) + "'", kCut);
  return static_cast<std::size_t>(n);
}

std::size_t VtkInput::product(std::size_t a, std::size_t b) const {
  if (b != 0 && a > std::numeric_limits<std::size_t>::max() / 16 / b)
    fail("more numbers are declared than the file holds", kCut);
  return a * b;
}

std::string VtkInput::name() {
  in_.skipSpace();
  const std::string_view rest = source_.bytes.substr(in_.position());
  if (!rest.empty() && rest[0] == '"') {
    const std::size_t end = rest.substr(0, 1000).find_first_of("\"\n\r", 1);
    if (end != rest.npos && rest[end] == '"') {
      in_.seek(in_.position() + end + 1);
      return percentDecoded(rest.substr(1, end - 1));
    }
  }
  return percentDecoded(in_.word());
}

Number VtkInput::type() {
  const std::string_view word = in_.word();
  const auto found = legacyNumber(word);
  if (!found)
    fail("unknown number type '" + readable(word) + "'", kExport);
  return *found;
}

bool VtkInput::next(std::string_view keyword) {
  const std::size_t before = in_.position();
  in_.skipSpace();
  const std::string_view rest = source_.bytes.substr(in_.position());
  if (keywordOf(rest.substr(0, keyword.size())) == keyword &&
      (rest.size() == keyword.size() || isBlank(rest[keyword.size()]))) {
    in_.seek(in_.position() + keyword.size());
    return true;
  }
  in_.seek(before);
  return false;
}

void VtkInput::endLine() {
  if (binary_ && !trimmed(in_.line()).empty())
    fail("more words than expected before binary data", kCut);
}

Array VtkInput::numbers(Number type, std::size_t n) {
  if (!binary_) {
    const std::string start = in_.where();
    Array array = parseText(in_, type, n, progress_);
    array.where = start;
    return array;
  }
  Array array;
  array.where = where();
  const std::uint64_t bytes = bytesFor(type, n);
  if (bytes > in_.remaining())
    fail(std::to_string(n) + " numbers are declared, more than the file holds", kCut);
  array.type = type;
  array.swap = machineIsLittleEndian();
  array.data = source_.bytes.data() + in_.position();
  array.count = n;
  in_.seek(in_.position() + bytes);
  return array;
}

void VtkInput::skipNumbers(Number type, std::size_t n) {
  if (binary_) {
    numbers(type, n);
    return;
  }
  in_.checkCount(static_cast<std::int64_t>(std::min<std::size_t>(n, SIZE_MAX / 2)), "numbers");
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 65536 == 0)
      progress_.check();
    if (in_.word().empty())
      in_.failNumber("a number");
  }
}

void VtkInput::skipMetadata() {
  in_.line();
  do
    if (in_.remaining() == 0)
      fail("the file ends within METADATA", kCut);
  while (!trimmed(in_.line()).empty());
}

void VtkInput::skipStrings(std::size_t n, bool counted) {
  for (std::size_t i = 0; i < n; ++i) {
    if (in_.remaining() == 0)
      fail("the file ends within strings", kCut);
    if (i % 65536 == 0)
      progress_.check();
    if (!counted) {
      in_.line();
      continue;
    }
    const char* at = source_.bytes.data() + in_.position();
    // The highest two bits of the first byte are the number of bytes of the length.
    const unsigned first = static_cast<unsigned char>(*at);
    const std::size_t bytes = std::size_t(8) >> (first >> 6);
    std::uint64_t length = first & 0x3f;
    if (bytes <= in_.remaining())
      for (std::size_t k = 1; k < bytes; ++k)
        length = length << 8 | static_cast<unsigned char>(at[k]);
    if (bytes > in_.remaining() || length > in_.remaining() - bytes)
      fail("a string is longer than the file", kCut);
    in_.seek(in_.position() + bytes + length);
  }
}

} // namespace tetvdb::vtk
