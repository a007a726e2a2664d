// SPDX-License-Identifier: Apache-2.0
//
// Writes lines of numbers to a text file; doubles read back the same.
#pragma once

#include "tetvdb/core/AtomicFile.h"

#include <charconv>
#include <cstddef>
#include <string_view>

namespace tetvdb {

/// At most eight numbers and a short word per line.
class TextLine {
public:
  explicit TextLine(AtomicFile& file) : file_(file) {}

  TextLine& word(std::string_view text) {
    for (const char c : text)
      *at_++ = c;
    *at_++ = ' ';
    return *this;
  }
  template <class T>
  TextLine& number(T value) {
    at_ = std::to_chars(at_, text_ + sizeof text_, value).ptr;
    *at_++ = ' ';
    return *this;
  }
  void end() {
    at_[-1] = '\n';
    file_.write(text_, static_cast<std::size_t>(at_ - text_));
    at_ = text_;
  }

private:
  AtomicFile& file_;
  char text_[256]; // eight numbers of at most 25 characters
  char* at_ = text_;
};

} // namespace tetvdb
