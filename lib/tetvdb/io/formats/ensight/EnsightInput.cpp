// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/ensight/EnsightInput.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/source/Advice.h"

#include <algorithm>

namespace tetvdb::ensight {
namespace {

constexpr std::size_t kRecord = 80; ///< characters of a record of text in a binary file

} // namespace

Input::Input(const Source& source, std::optional<std::size_t> step)
    : text_(source), bytes_(source) {
  const std::string_view start = source.bytes.substr(0, kRecord);
  if (start.substr(0, 20).find("Fortran Binary") != start.npos)
    throw Error(Status::Invalid, source.path, "is a Fortran binary file, which is not read",
                "write it as C binary or ASCII");
  binary_ = start.substr(0, 8) == "C Binary";
  if (binary_)
    bytes_.skip(kRecord);
  if (step)
    openStep(source, *step);
}

Input::Input(const Source& source, bool isBinary, std::optional<std::size_t> step)
    : binary_(isBinary), text_(source), bytes_(source) {
  if (step)
    openStep(source, *step);
}

// The lines or records between those that begin and end the step. In binary files they are looked
// for among the numbers as well, which are not these letters.
void Input::openStep(const Source& source, std::size_t step) {
  constexpr std::string_view begins = "BEGIN TIME STEP", ends = "END TIME STEP";
  std::size_t at = source.bytes.find(begins);
  for (std::size_t i = 0; i < step && at != source.bytes.npos; ++i)
    at = source.bytes.find(begins, at + begins.size());
  if (at == source.bytes.npos)
    throw Error(Status::Invalid, source.path,
                "has no step " + std::to_string(step + 1) + " ('BEGIN TIME STEP')", kCut);
  const std::size_t end = source.bytes.find(ends, at);
  if (end == source.bytes.npos)
    throw Error(Status::Invalid, source.path,
                "step " + std::to_string(step + 1) + " does not end ('END TIME STEP')", kCut);
  const std::string_view until = source.bytes.substr(0, end);
  text_ = NumberParser(until, source.path, 0, at);
  text_.line();
  bytes_ = ByteReader(until, source.path, false, std::min(at + kRecord, end));
}

bool Input::atEnd() {
  return binary_ ? bytes_.remaining() == 0 : text_.atEnd();
}

std::string Input::line() {
  if (binary_)
    return trimmedRecord(bytes_.take(kRecord));
  if (text_.remaining() == 0)
    fail("the file ends early", "it is cut off; export it again");
  return trimmedRecord(text_.line());
}

std::string Input::keyword() {
  if (!binary_)
    text_.skipSpace();
  return line();
}

std::int64_t Input::integer() {
  if (binary_)
    return bytes_.get<std::int32_t>();
  const std::int64_t n = text_.integer();
  text_.line();
  return n;
}

std::int64_t Input::partNumber() {
  if (!binary_ || orderKnown_)
    return integer();
  orderKnown_ = true;
  const std::int32_t number = bytes_.get<std::int32_t>();
  const std::int32_t other = byteSwapped(number);
  const bool swap = static_cast<std::uint32_t>(other) < static_cast<std::uint32_t>(number);
  bytes_.setSwap(swap);
  return swap ? other : number;
}

std::size_t Input::count(const char* things, std::size_t numbersEach) {
  const std::int64_t n = integer();
  if (binary_)
    return bytes_.checkCount(n, 4 * numbersEach, things);
  text_.checkCount(n, things, 2 * numbersEach);
  return static_cast<std::size_t>(n);
}

std::vector<std::int64_t> Input::integers(std::size_t n) {
  std::vector<std::int64_t> numbers;
  if (binary_) {
    numbers.resize(bytes_.checkCount(n, 4, "numbers"));
    bytes_.read<std::int32_t>(numbers.data(), n);
    return numbers;
  }
  text_.checkCount(static_cast<std::int64_t>(n), "numbers", 2);
  numbers.reserve(n);
  for (std::size_t i = 0; i < n; ++i)
    numbers.push_back(text_.integer());
  return numbers;
}

void Input::reals(float* to, std::size_t n) {
  if (binary_)
    return bytes_.read<float>(to, n);
  for (std::size_t i = 0; i < n; ++i)
    to[i] = static_cast<float>(text_.value());
}

void Input::skipReals(std::size_t n) {
  if (binary_)
    return bytes_.skip(4 * std::uint64_t(n));
  for (std::size_t i = 0; i < n; ++i)
    text_.value();
}

void Input::fail(const std::string& what, const char* advice) const {
  throw Error(Status::Invalid, binary_ ? bytes_.where() : text_.where(), what, advice);
}

} // namespace tetvdb::ensight
