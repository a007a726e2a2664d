// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/text/ByteReader.h"

#include <gtest/gtest.h>
#include <limits>

namespace tetvdb {
namespace {

TEST(ByteReader, BothByteOrders) {
  const std::string bytes("\x01\x00\x00\x00\x00\x00\x00\x02\x3f\x80\x00\x00", 12);
  ByteReader in(bytes, "file");
  EXPECT_EQ(in.get<std::int32_t>(), 1);
  in.setSwap(true);
  EXPECT_EQ(in.get<std::uint32_t>(), 2U);
  EXPECT_EQ(in.get<float>(), 1.0F);
  EXPECT_EQ(in.remaining(), 0U);
}

TEST(ByteReader, BulkReadsConvert) {
  const std::string bytes("\x00\x01\xff\xff", 4);
  double values[2];
  ByteReader(bytes, "file", true).read<std::int16_t>(values, 2);
  EXPECT_EQ(values[0], 1);
  EXPECT_EQ(values[1], -1);
  std::int16_t same[2];
  ByteReader(bytes, "file").read<std::int16_t>(same, 2);
  EXPECT_EQ(same[0], 256);
}

TEST(ByteReader, NothingBeyondTheEnd) {
  const std::string bytes(10, 'x');
  ByteReader in(bytes, "a.bin");
  in.skip(8);
  try {
    in.get<std::int32_t>();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find("a.bin at byte 8: the file ends 2 bytes early"), 0U)
        << error.what();
  }
  EXPECT_EQ(in.remaining(), 2U);
  EXPECT_THROW(in.take(std::numeric_limits<std::uint64_t>::max()), Error);
  EXPECT_THROW(in.seek(11), Error);
  EXPECT_NO_THROW(in.seek(10));
  std::uint64_t none = 0;
  EXPECT_THROW(in.read<std::uint64_t>(&none, 1), Error);
  EXPECT_NO_THROW(in.read<std::uint64_t>(&none, 0));
}

TEST(ByteReader, CountsAreCheckedAgainstTheBytes) {
  const std::string bytes(16, 'x');
  const ByteReader in(bytes, "file");
  EXPECT_EQ(in.checkCount(2, 8, "nodes"), 2U);
  EXPECT_THROW(in.checkCount(3, 8, "nodes"), Error);
  EXPECT_THROW(in.checkCount(-1, 8, "nodes"), Error);
  EXPECT_THROW(in.checkCount(std::numeric_limits<std::uint64_t>::max(), 8, "nodes"), Error);
}

} // namespace
} // namespace tetvdb
