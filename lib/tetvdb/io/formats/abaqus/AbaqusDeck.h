// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/text/NumberParser.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// The lines of an Abaqus deck: keyword lines, "*NODE, NSET=ALL", and data lines, comma separated.
/// The lines of a file that an *INCLUDE names come in its place.
class AbaqusDeck {
public:
  explicit AbaqusDeck(const Source& source)
      : path_(source.path), files_{NumberParser(source)}, bytes_(source.bytes.size()) {}

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
  /// Inserts the lines of a file, whose name is relative to the deck's folder, before the next one.
  /// Throws Error(Invalid) as pathWithin() does, and where too many files include one another.
  void include(const std::string& name);

  std::int64_t integer(std::string_view field) const;
  double real(std::string_view field) const;

  /// In the deck itself.
  std::size_t position() const { return files_.front().position(); }
  /// Of all files opened.
  std::size_t bytes() const { return bytes_; }
  [[noreturn]] void fail(std::string_view what, std::string_view advice = {}) const {
    NumberParser at = files_[at_.file];
    at.seek(at_.position);
    at.fail(what, advice);
  }

private:
  using Parameters = std::map<std::string, std::string>;
  struct Line {
    std::size_t file = 0, position = 0;
    std::string_view text;
  };
  NumberParser& file() { return files_[open_.back()]; }
  bool readLine();
  Parameters readParameters(std::string_view line, std::string_view rest);

  std::string path_;
  std::deque<MappedFile> included_;
  std::deque<NumberParser> files_;   ///< the deck, and all that were included
  std::vector<std::size_t> open_{0}; ///< of these: each includes the next one
  std::size_t bytes_;
  Line line_;            ///< the last one read
  bool isAhead_ = false; ///< it is still to be used
  Line at_;              ///< the current one, for messages
  std::string keyword_;
  Parameters parameters_;
  std::string_view fields_; ///< rest of a data line
  bool continues_ = false;
};

/// "Set-1" and "SET-1" are the same name.
std::string abaqusName(std::string_view text);

} // namespace tetvdb
