// SPDX-License-Identifier: Apache-2.0
//
// The entries of a Nastran deck, in small, large and free fields, with their continuation lines.
//
//   tetvdb::NastranDeck deck(source);
//   while (deck.next())
//     if (deck.name() == "GRID") ... deck.integer(1) ... deck.real(3) ...
#pragma once

#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/text/NumberParser.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// The bulk data: what follows BEGIN BULK, or all of a file without it, to ENDDATA.
class NastranDeck {
public:
  explicit NastranDeck(const Source& source);

  /// Moves to the next entry; false at the end.
  bool next();
  /// In capitals, without the '*' of large fields.
  const std::string& name() const { return name_; }
  /// Of an INCLUDE: the name of the other file.
  const std::string& includedFile() const { return includedFile_; }
  /// A field, counted from 1, without spaces; empty beyond the last.
  std::string_view field(std::size_t number) const {
    return number <= fields_.size() ? fields_[number - 1] : std::string_view();
  }
  /// An integer; none for an empty field. Throws Error(Invalid) for anything else.
  std::optional<std::int64_t> integer(std::size_t number) const;
  /// A real number in Nastran's forms ("1.5-3" is 0.0015); 0 for an empty field. Throws likewise.
  double real(std::size_t number) const;

  std::size_t position() const { return in_.position(); }
  [[noreturn]] void fail(const std::string& what, const char* advice) const {
    in_.fail("the entry '" + name_ + "' before this line: " + what, advice);
  }

private:
  /// Sets line_ to the next line that is not empty, without comment; false at the end.
  bool readLine();
  bool isContinuation() const;
  void readInclude();
  void addFields(bool isFirst);

  NumberParser in_;
  std::string_view line_; ///< the one after the entry
  bool hasLine_ = false;
  std::deque<std::string> expanded_; ///< lines of the entry that have tabs
  std::string name_;
  std::vector<std::string_view> fields_;
  std::string includedFile_;
};

/// A number without spaces; none if the text is not one.
std::optional<double> nastranReal(std::string_view text);

} // namespace tetvdb
