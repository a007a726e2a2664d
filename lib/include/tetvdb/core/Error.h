// SPDX-License-Identifier: Apache-2.0
//
// The one exception type of the library. A message has three parts: where it happened (a file, a
// file and line, a setting), what is wrong, and what to do about it. Texts of errors, warnings and
// findings name a setting between backquotes, with a value as `name=value`: a program spells it as
// its users know it (--name value on the command line).
//
//   throw tetvdb::Error(tetvdb::Status::Invalid, "a.msh:12", "vertex 7 is not a finite number",
//                       "repair the file or export it again");
//   throw tetvdb::Error(tetvdb::Status::Limit, "", "not enough memory", "raise `max_memory`");
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace tetvdb {

/// How a job ended; the numbers are the exit statuses of the command line.
enum class Status : int {
  Ok = 0,        ///< done
  Partial = 1,   ///< a result was written, but a promise was not met; the report says which
  Usage = 2,     ///< bad options
  Invalid = 3,   ///< unreadable, invalid or empty input or result; nothing written
  Limit = 4,     ///< memory or size limit; nothing written
  Cancelled = 5, ///< cancelled or timed out; nothing written
  Device = 6,    ///< device not available
  Write = 7,     ///< cannot write
  Found = 8      ///< `compare` or `check` found something
};

/// Thrown by every public function that fails. `what()` is one line: "where: what; advice".
class Error : public std::runtime_error {
public:
  Error(Status status, std::string_view where, std::string_view what, std::string_view advice = {})
      : std::runtime_error(line(where, what, advice)), status_(status) {}

  Status status() const noexcept { return status_; }

private:
  static std::string line(std::string_view where, std::string_view what, std::string_view advice) {
    std::string text(where);
    if (!text.empty())
      text += ": ";
    text += what;
    if (!advice.empty())
      (text += "; ") += advice;
    return text;
  }

  Status status_;
};

} // namespace tetvdb
