// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/text/NumberParser.h"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace tetvdb {

/// The lines of an Abaqus deck: keyword lines, "*NODE, NSET=ALL", and data lines, comma separated.
class AbaqusDeck {
public:
  explicit AbaqusDeck(const Source& source) : in_(source) {}

  /// Moves to the next keyword line, skipping comments and remaining data lines; false at the
  /// end.
  bool nextKeyword();
  /// In capitals without blanks: "SOLIDSECTION".
  const std::string& keyword() const { return keyword_; }
  /// Value of a parameter of the keyword line, "" for one without value; null if it is absent.
  /// Parameter names are in capitals, values as in the file without surrounding blanks.
  const std::string* parameter(const std::string& name) const;

  /// Moves to the next data line; false at the next keyword.
  bool nextLine();
  /// Reads the next field of the data line, without blanks; false if there is none left.
  bool nextField(std::string_view& field);
  /// Whether the data line continues in the next one (it ends with a comma).
  bool continues() const { return continues_; }

  std::int64_t integer(std::string_view field) const;
  double real(std::string_view field) const;

  std::size_t position() const { return in_.position(); }
  [[noreturn]] void fail(std::string_view what, std::string_view advice = {}) const {
    at_.fail(what, advice);
  }

private:
  NumberParser in_;
  NumberParser at_ = in_; ///< at the current line, for messages
  std::string keyword_;
  std::map<std::string, std::string> parameters_;
  std::string_view line_;
  bool continues_ = false;
};

/// "Set-1" and "SET-1" are the same name.
std::string abaqusName(std::string_view text);

} // namespace tetvdb
