// SPDX-License-Identifier: Apache-2.0
#include "FileBytes.h"
#include "TemporaryFolder.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/text/ZipWriter.h"

#include <cstdint>
#include <gtest/gtest.h>
#include <string>

namespace tetvdb {
namespace {

class ZipFile : public ::testing::Test {
protected:
  std::string bytes() const { return test::fileBytes(path_); }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "a.zip";
};

std::uint64_t number(const std::string& bytes, std::size_t at, std::size_t size) {
  std::uint64_t sum = 0;
  for (std::size_t i = size; i-- > 0;)
    sum = sum << 8 | static_cast<unsigned char>(bytes.at(at + i));
  return sum;
}

// Offsets of fields as APPNOTE.TXT has them.
TEST_F(ZipFile, AFileThatMayBeLargeHasItsSizesIn64Bits) {
  {
    AtomicFile file(path_);
    ZipWriter zip(file);
    zip.begin("big", ZipMethod::Stored, std::uint64_t(5) << 30);
    zip.write("some ");
    zip.write("bytes");
    zip.end();
    zip.begin("small", ZipMethod::Stored, 4);
    zip.write("more");
    zip.end();
    zip.finish();
    file.commit();
  }
  const std::string zip = bytes();
  ASSERT_EQ(zip.substr(0, 4), "PK\x03\x04");
  EXPECT_EQ(number(zip, 4, 2), 45u);          // the version that is needed
  EXPECT_EQ(number(zip, 14, 4), 0x9f597f55u); // CRC-32 of "some bytes"
  EXPECT_EQ(number(zip, 18, 4), 0xffffffffu);
  EXPECT_EQ(number(zip, 22, 4), 0xffffffffu);
  ASSERT_EQ(number(zip, 28, 2), 20u); // the extra field
  EXPECT_EQ(number(zip, 33, 2), 1u);  // after the name
  EXPECT_EQ(number(zip, 35, 2), 16u);
  EXPECT_EQ(number(zip, 37, 8), 10u);
  EXPECT_EQ(number(zip, 45, 8), 10u);
  EXPECT_EQ(zip.substr(53, 10), "some bytes");
  EXPECT_EQ(number(zip, 63 + 4, 2), 20u); // the small one is plain
  EXPECT_EQ(number(zip, 63 + 18, 4), 4u);
  const std::size_t directory = number(zip, zip.size() - 6, 4);
  ASSERT_EQ(zip.substr(directory, 4), "PK\x01\x02");
  EXPECT_EQ(number(zip, directory + 20, 4), 0xffffffffu);
  ASSERT_EQ(number(zip, directory + 30, 2), 20u);
  EXPECT_EQ(number(zip, directory + 46 + 3 + 4, 8), 10u);
  EXPECT_EQ(number(zip, directory + 46 + 3 + 12, 8), 10u);
  EXPECT_EQ(number(zip, zip.size() - 12, 2), 2u);
}

} // namespace
} // namespace tetvdb
