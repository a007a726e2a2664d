// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/ensight/EnsightInput.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"

#include <algorithm>

namespace tetvdb::ensight {
namespace {

constexpr std::size_t kRecord = 80; ///< characters of a record of text in a binary file

} // namespace

Input::Input(const Source& source) : text_(source), bytes_(source) {
  const std::string_view start = source.bytes.substr(0, kRecord);
  if (start.substr(0, 20).find("Fortran Binary") != start.npos)
    throw Error(Status::Invalid, source.path, "is a Fortran binary file, which is not read",
                "write it as C binary or ASCII");
  binary_ = start.substr(0, 8) == "C Binary";
  if (binary_)
    bytes_.skip(kRecord);
}

Input::Input(const Source& source, bool isBinary)
    : binary_(isBinary), text_(source), bytes_(source) {}

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
