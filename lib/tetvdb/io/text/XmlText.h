// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace tetvdb {

/// Text as the value of an XML attribute in double quotes: markup is escaped, and control
/// characters, which XML cannot represent, become blanks.
inline std::string xmlAttributeText(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out;
}

} // namespace tetvdb
