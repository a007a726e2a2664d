// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/cells/IdMap.h"

#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <rapidcheck/gtest.h>

namespace tetvdb {
namespace {

IdMap mapOf(const std::vector<std::int64_t>& ids) {
  IdMap map;
  for (const std::int64_t id : ids)
    map.add(id);
  map.finish();
  return map;
}

TEST(IdMap, ConsecutiveNumbers) {
  const IdMap map = mapOf({5, 6, 7});
  EXPECT_TRUE(map.consecutive());
  EXPECT_EQ(map.find(7), 2U);
  EXPECT_EQ(map.find(4), IdMap::kNone);
  EXPECT_EQ(map.find(8), IdMap::kNone);
  EXPECT_EQ(mapOf({}).find(0), IdMap::kNone);
}

TEST(IdMap, LaterDuplicatesCount) {
  EXPECT_EQ(mapOf({1, 2, 1}).find(1), 2U);
  EXPECT_EQ(mapOf({1, 2, 1}).duplicates(), 1U);
  const IdMap far = mapOf({1, std::int64_t(1) << 60, 1});
  EXPECT_EQ(far.find(1), 2U);
  EXPECT_EQ(far.duplicates(), 1U);
}

TEST(IdMap, ExtremeNumbers) {
  constexpr auto low = std::numeric_limits<std::int64_t>::min();
  constexpr auto high = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(mapOf({high, low, 0}).find(low), 1U);
  EXPECT_EQ(mapOf({high}).find(high), 0U);
  EXPECT_EQ(mapOf({high}).find(low), IdMap::kNone);
}

RC_GTEST_PROP(IdMap, FindsWhatAMapFinds, (std::vector<std::int16_t> small, bool spread)) {
  std::map<std::int64_t, std::uint32_t> wanted;
  std::vector<std::int64_t> ids;
  for (const std::int16_t id : small) {
    ids.push_back(spread ? id * std::int64_t(1000003) : id % 50);
    wanted[ids.back()] = static_cast<std::uint32_t>(ids.size() - 1);
  }
  const IdMap map = mapOf(ids);
  for (const auto& [id, index] : wanted) {
    RC_ASSERT(map.find(id) == index);
    if (wanted.count(id + 1) == 0)
      RC_ASSERT(map.find(id + 1) == IdMap::kNone);
  }
  RC_ASSERT(map.duplicates() == ids.size() - wanted.size());
}

} // namespace
} // namespace tetvdb
