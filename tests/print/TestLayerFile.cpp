// SPDX-License-Identifier: Apache-2.0
#include "FileBytes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/print/LayerFile.h"

#include <gtest/gtest.h>
#include <sstream>

namespace tetvdb {
namespace {

TEST(LayerFile, EveryFormatIsInTheBook) {
  const std::string page = test::fileBytes(std::string(TETVDB_TEST_DATA) + "/../../docs/print.md");
  ASSERT_FALSE(page.empty());
  for (const LayerFormat& format : layerFormats()) {
    EXPECT_NE(page.find("`" + std::string(format.name) + "`"), std::string::npos) << format.name;
    std::istringstream endings{std::string(format.endings)};
    for (std::string ending; endings >> ending;)
      EXPECT_NE(page.find("`" + ending + "`"), std::string::npos) << ending;
  }
}

TEST(LayerFile, EndingsAndNamesChoose) {
  EXPECT_EQ(layerFormatFor("a/part.sl1", "").name, "sl1");
  EXPECT_EQ(layerFormatFor("part.SL1S", "").name, "sl1");
  EXPECT_EQ(layerFormatFor("part.cli", "").name, "cli");
  EXPECT_EQ(layerFormatFor("part.cli", "cli-binary").name, "cli-binary");
  EXPECT_EQ(layerFormatFor("layers", "").name, "png");
  EXPECT_EQ(layerFormatFor("layers", "bmp").name, "bmp");
  EXPECT_THROW(layerFormatFor("part.sl", ""), Error);
  EXPECT_THROW(layerFormatFor("part.sl1", "sl"), Error);
}

TEST(LayerFile, NamesHavePlainLetters) {
  PrintInfo info;
  info.path = "folder/My part \xc3\xa4 (1).sl1";
  EXPECT_EQ(info.name(), "My_part_____1_");
  info.path = "/";
  EXPECT_EQ(info.name(), "print");
}

} // namespace
} // namespace tetvdb
