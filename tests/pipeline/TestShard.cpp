// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/Shard.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

TEST(Shard, IsReadFromText) {
  const Shard shard = parseShard("3/16");
  EXPECT_EQ(shard.index, 3u);
  EXPECT_EQ(shard.count, 16u);
  EXPECT_FALSE(shard.isWhole());
  EXPECT_EQ(shard.name(), "3-of-16");
  EXPECT_TRUE(parseShard("0/1").isWhole());
}

TEST(Shard, RefusesWhatIsNone) {
  for (const char* text : {"", "3", "16/16", "0/0", "-1/4", "1/-4", "a/4", "1/4x", " 1/4", "1//4",
                           "1/99999999999", "Auto"})
    EXPECT_THROW(parseShard(text), Error) << text;
}

} // namespace
} // namespace tetvdb
