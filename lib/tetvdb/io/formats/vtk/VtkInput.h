// SPDX-License-Identifier: Apache-2.0
//
// The syntax of VTK's legacy files: words and counts as text, numbers as text or in binary.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/formats/vtk/VtkArray.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/text/NumberParser.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace tetvdb::vtk {

/// A keyword in lower case; longer words are not keywords.
std::string keywordOf(std::string_view word);
/// Part of a file as it can be shown in a message.
std::string readable(std::string_view word);

/// Methods throw Error(Invalid) where the file has something else.
class VtkInput {
public:
  VtkInput(const Source& source, Progress& progress)
      : source_(source), progress_(progress), in_(source) {}

  NumberParser& text() { return in_; }
  bool isBinary() const { return binary_; }
  void setBinary(bool binary) { binary_ = binary; }

  /// "file:line" or "file at byte N".
  std::string where() const;
  [[noreturn]] void fail(const std::string& what, const char* advice) const;

  std::string word() { return keywordOf(in_.word()); }
  std::size_t count();
  /// a * b, as a number of numbers.
  std::size_t product(std::size_t a, std::size_t b) const;
  /// A name, which may be quoted and contains %20 for a space, and so on.
  std::string name();
  Number type();
  /// Whether the next word is `keyword` (lower case), which is then consumed. Reads no more than
  /// that many bytes, since binary data may follow.
  bool next(std::string_view keyword);
  /// Binary data begin on the next line.
  void endLine();
  /// The `n` numbers that follow the header line.
  Array numbers(Number type, std::size_t n);
  void skipNumbers(Number type, std::size_t n);
  /// One per line, or in binary, if `counted`, each after its length.
  void skipStrings(std::size_t n, bool counted);
  /// Skips lines up to an empty one.
  void skipMetadata();

private:
  const Source& source_;
  Progress& progress_;
  NumberParser in_;
  bool binary_ = false;
};

} // namespace tetvdb::vtk
