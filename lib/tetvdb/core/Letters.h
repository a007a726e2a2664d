// SPDX-License-Identifier: Apache-2.0
//
// Text of files and of users by ASCII, whatever the locale.
#pragma once

#include <string>
#include <string_view>

namespace tetvdb {

inline bool isBlank(char c) {
  return static_cast<unsigned char>(c) <= ' ';
}

inline bool isLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

inline bool isLineBreak(char c) {
  return c == '\n' || c == '\r';
}

/// Without blanks and control characters at both ends.
inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back()))
    text.remove_suffix(1);
  return text;
}

/// A record of fixed length, which a zero may end early.
inline std::string trimmedRecord(std::string_view record) {
  return std::string(trimmed(record.substr(0, record.find('\0'))));
}

inline std::string lowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

} // namespace tetvdb
