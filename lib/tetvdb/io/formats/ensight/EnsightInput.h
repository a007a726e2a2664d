// SPDX-License-Identifier: Apache-2.0
//
// One file of an EnSight Gold mesh, text or C binary, as lines and numbers.
#pragma once

#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/text/NumberParser.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb::ensight {

/// A cursor. Throws Error(Invalid) with the position if the file ends early or a number is invalid.
class Input {
public:
  /// A geometry file: reads the record "C Binary" if it begins with it. Throws for Fortran's binary
  /// files. `step`: of a file that holds several, from 0 on.
  explicit Input(const Source& source, std::optional<std::size_t> step = {});
  /// A variable's file, which is binary if the geometry is, without a mark.
  Input(const Source& source, bool isBinary, std::optional<std::size_t> step);

  bool isBinary() const { return binary_; }
  /// Whether only white space is left.
  bool atEnd();
  /// The next line or record of 80 characters, trimmed; for text also an empty one.
  std::string line();
  /// The next line that is not empty: a keyword.
  std::string keyword();
  /// An integer; skips the rest of its line.
  std::int64_t integer();
  /// A count of elements, each of which has at least one number in the file.
  std::size_t count(const char* things, std::size_t numbersEach = 1);
  std::vector<std::int64_t> integers(std::size_t n);
  /// Accepts NaN and infinities.
  void reals(float* to, std::size_t n);
  void skipReals(std::size_t n);

  /// The number before a file's first part, which determines the byte order.
  std::int64_t partNumber();

  [[noreturn]] void fail(const std::string& what, const char* advice) const;

private:
  void openStep(const Source& source, std::size_t step);

  bool binary_ = false;
  bool orderKnown_ = false;
  NumberParser text_;
  ByteReader bytes_;
};

} // namespace tetvdb::ensight
