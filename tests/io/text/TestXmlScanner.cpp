// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/text/XmlScanner.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

/// Begins as "(name", ends as ")".
std::string shape(const std::string& text) {
  XmlScanner in(text, "file");
  std::string result;
  while (in.next())
    result += in.begins() ? "(" + std::string(in.name()) : std::string(")");
  return result;
}

TEST(XmlScanner, BeginsAndEnds) {
  EXPECT_EQ(shape("<a><b/><c>text</c></a>"), "(a(b)(c))");
  EXPECT_EQ(shape("<a >\n<b x='>' />\n<b\n/></a >"), "(a(b)(b))");
}

TEST(XmlScanner, SkipsWhatIsNoTag) {
  EXPECT_EQ(shape("<?xml a='>'?><!DOCTYPE a>t<a><!-- <z> --><![CDATA[<y>]]><b></b></a>\n"),
            "(a(b))");
  EXPECT_EQ(shape("no tags"), "");
}

TEST(XmlScanner, NamesWithoutPrefix) {
  const std::string text = "<p:a><q:b><c p:x='1' y=\"it's\" z = '2'/></q:b></p:a>";
  XmlScanner in(text, "file");
  for (const char* name : {"a", "b", "c"}) {
    ASSERT_TRUE(in.next());
    EXPECT_EQ(in.name(), name);
  }
  EXPECT_EQ(in.around(1), "b");
  EXPECT_EQ(in.around(2), "a");
  EXPECT_EQ(in.around(3), "");
  EXPECT_EQ(in.attribute("x"), "1");
  EXPECT_EQ(in.attribute("p:x"), "1");
  EXPECT_EQ(in.attribute("q:x"), "");
  EXPECT_EQ(in.attribute("y"), "it's");
  EXPECT_EQ(in.attribute("z"), "2");
  EXPECT_EQ(in.attribute("w"), "");
  ASSERT_TRUE(in.next());
  EXPECT_FALSE(in.begins());
  EXPECT_EQ(in.around(1), "b");
}

TEST(XmlScanner, BrokenTextsAreErrorsWithALine) {
  for (const char* text : {"<a>\n", "\n<a", "\n<", "\n</a>", "<a>\n</b></a>", "<a>\n<b x></b></a>",
                           "<a>\n<b x=1/></a>", "<a>\n<b x='1/></a>", "\n<!-- ", "<a>\n</a",
                           "\n<a / b>", "<a\n<b></b>"})
    try {
      shape(text);
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Invalid);
      EXPECT_EQ(std::string(error.what()).find("file:2: "), 0U) << text << error.what();
    }
  std::string deep;
  for (int i = 0; i < 5000; ++i)
    deep += "<a>";
  EXPECT_THROW(shape(deep), Error);
}

} // namespace
} // namespace tetvdb
