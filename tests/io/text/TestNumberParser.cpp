// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/text/NumberParser.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <vector>

namespace tetvdb {
namespace {

double real(std::string_view text) {
  return NumberParser(text, "file").real();
}

bool fails(std::string_view text) {
  double value = 0;
  return !NumberParser(text, "file").tryReal(value);
}

TEST(NumberParser, ManyWaysToWriteANumber) {
  EXPECT_EQ(real("1.5"), 1.5);
  EXPECT_EQ(real(" \t\r\n+2"), 2);
  EXPECT_EQ(real("-.5e1"), -5);
  EXPECT_EQ(real("1.5D+03"), 1500);
  EXPECT_EQ(real("2d5"), 2e5);
  EXPECT_EQ(real("1.234-103"), 1.234e-103);
  EXPECT_EQ(real("1e-400"), 0);
  EXPECT_EQ(real("-1e-99999"), 0);
  EXPECT_EQ(real("0." + std::string(100, '0') + "1"), 1e-101);
  EXPECT_EQ(real("1.5,2"), 1.5);
  EXPECT_EQ(real("7<"), 7);
}

TEST(NumberParser, WhatIsNoNumber) {
  for (const char* text : {"", "abc", "1..2", "+-3", "1e", "1.5x", "--1", "0x10"})
    EXPECT_TRUE(fails(text)) << text;
  for (const char* text : {"nan", "inf", "-infinity", "1e400", "1e99999"})
    EXPECT_THROW(real(text), Error) << text;
  EXPECT_TRUE(std::isnan(NumberParser("nan", "file").value()));
}

TEST(NumberParser, TextThatEndsWithTheMemory) {
  for (const char c : {'I', 'N', 'i', 'n', '1', '.', '-', 'x'})
    for (const std::size_t n : {1U, 40U, 63U, 200U, 500U}) {
      const std::string text(n, c);
      const std::vector<char> exact(text.begin(), text.end()); // no zero behind it
      double value = 0;
      NumberParser({exact.data(), exact.size()}, "file").tryReal(value);
    }
  EXPECT_THROW(real(std::string(400, '1')), Error);
  EXPECT_EQ(real("0." + std::string(400, '0') + "1"), 0);
}

TEST(NumberParser, WholeNumbers) {
  EXPECT_EQ(NumberParser("+12", "file").integer(), 12);
  EXPECT_EQ(NumberParser("3.0", "file").realInteger(), 3);
  EXPECT_THROW(NumberParser("3.0", "file").integer(), Error);
  EXPECT_THROW(NumberParser("3.5", "file").realInteger(), Error);
  EXPECT_THROW(NumberParser("99999999999999999999", "file").integer(), Error);
}

TEST(NumberParser, CommentsAndLines) {
  NumberParser in("1 # one 5\n2\r\n3\rend of line\nword#x", "file", '#');
  EXPECT_EQ(in.integer(), 1);
  EXPECT_EQ(in.integer(), 2);
  EXPECT_EQ(in.integer(), 3);
  EXPECT_EQ(in.lineNumber(), 3U);
  EXPECT_EQ(in.line(), "");
  EXPECT_EQ(in.line(), "end of line");
  EXPECT_EQ(in.peekWord(), "word");
  EXPECT_EQ(in.word(), "word");
  EXPECT_TRUE(in.atEnd());
  EXPECT_EQ(in.line(), "");
}

TEST(NumberParser, MessagesNameLineAndWord) {
  NumberParser in("1\n2\r\n3\rx\x01y", "a.msh");
  in.integer(), in.integer(), in.integer();
  try {
    in.real();
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "a.msh:4: expected a number, found 'x'");
    EXPECT_EQ(error.status(), Status::Invalid);
  }
}

TEST(NumberParser, CountsAreCheckedAgainstTheText) {
  EXPECT_EQ(NumberParser("3 1 2 3", "file").count("things"), 3U);
  EXPECT_THROW(NumberParser("5 1 2 3", "file").count("things"), Error);
  EXPECT_THROW(NumberParser("-1 1 2 3", "file").count("things"), Error);
  EXPECT_THROW(NumberParser("9223372036854775807 1", "file").count("things", 8), Error);
}

RC_GTEST_PROP(NumberParser, ShortestDoublesReadBackTheSame, (double value)) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  RC_ASSERT(real(std::string_view(text, static_cast<std::size_t>(end - text))) == value);
}

} // namespace
} // namespace tetvdb
