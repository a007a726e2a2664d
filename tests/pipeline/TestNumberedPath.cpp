// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/FindFrames.h"
#include "tetvdb/pipeline/NumberedPath.h"

#include <gtest/gtest.h>

namespace {

using namespace tetvdb;

TEST(NumberedPath, LastDigitsOfTheName) {
  const NumberedPath path("out7/a2.0007b.vdb");
  EXPECT_EQ(path.before, "out7/a2.");
  EXPECT_EQ(path.digits, "0007");
  EXPECT_EQ(path.after, "b");
  EXPECT_EQ(path.extension, ".vdb");
  EXPECT_EQ(path.number, 7u);
}

TEST(NumberedPath, WithoutANumber) {
  const NumberedPath none("out7/a.vdb");
  EXPECT_EQ(none.before, "out7/a");
  EXPECT_EQ(none.after, "");
  EXPECT_FALSE(none.number);
  EXPECT_FALSE(NumberedPath("99999999999999999999999.vdb").number);
  EXPECT_FALSE(NumberedPath("").number);
}

TEST(NumberedPath, WhichFilesAreFrames) {
  EXPECT_TRUE(isNumbered({"a/f_8.vtu", "a/f_10.vtu"}));
  EXPECT_TRUE(isNumbered({"1.stl", "2.stl", "3.stl"}));
  EXPECT_FALSE(isNumbered({"f_8.vtu"}));
  EXPECT_FALSE(isNumbered({"f_8.vtu", "f_08.vtu"})); // one number twice
  EXPECT_FALSE(isNumbered({"f_8.vtu", "g_9.vtu"}));
  EXPECT_FALSE(isNumbered({"f_8.vtu", "f_9.vtk"}));
  EXPECT_FALSE(isNumbered({"a/f_8.vtu", "b/f_9.vtu"}));
  EXPECT_FALSE(isNumbered({"f8_left.vtu", "f9_right.vtu"}));
  EXPECT_FALSE(isNumbered({"f.vtu", "g.vtu"}));
}

} // namespace
