// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/visualize/Srgb.h"
#include "tetvdb/visualize/WritePng.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <png.h>
#include <sstream>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

struct ReadBack {
  png_uint_32 width = 0, height = 0;
  int depth = 0, colorType = 0, intent = -1;
  bool hasSrgb = false;
  std::vector<std::uint8_t> bytes;
};

// By libpng's full interface, which the writer does not use.
ReadBack readPng(const std::string& path) {
  ReadBack result;
  std::FILE* file = std::fopen(path.c_str(), "rb");
  EXPECT_NE(file, nullptr);
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  if (setjmp(png_jmpbuf(png)) != 0) {
    ADD_FAILURE() << "libpng cannot read " << path;
    return {};
  }
  png_init_io(png, file);
  png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  png_get_IHDR(png, info, &result.width, &result.height, &result.depth, &result.colorType, nullptr,
               nullptr, nullptr);
  result.hasSrgb = png_get_sRGB(png, info, &result.intent) != 0;
  png_bytepp rows = png_get_rows(png, info);
  const std::size_t stride = png_get_rowbytes(png, info);
  for (png_uint_32 row = 0; row < result.height; ++row)
    result.bytes.insert(result.bytes.end(), rows[row], rows[row] + stride);
  png_destroy_read_struct(&png, &info, nullptr);
  std::fclose(file);
  return result;
}

class WritePng : public testing::Test {
protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "tetvdb-png-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(WritePng, ComesBackAsItWas) {
  Image image(37, 11);
  for (int y = 0; y < 11; ++y)
    for (int x = 0; x < 37; ++x)
      image.at(x, y) = opaque(rgbOfHex(static_cast<std::uint32_t>(x * 6) << 16 |
                                       static_cast<std::uint32_t>(y * 20) << 8 |
                                       static_cast<std::uint32_t>(x * y % 256)));
  const std::string path = folder_ / "a.png";
  writePng(path, image);
  const ReadBack back = readPng(path);
  ASSERT_EQ(back.width, 37U);
  ASSERT_EQ(back.height, 11U);
  EXPECT_EQ(back.depth, 8);
  EXPECT_EQ(back.colorType, PNG_COLOR_TYPE_RGB);
  EXPECT_TRUE(back.hasSrgb);
  ASSERT_EQ(back.bytes.size(), 37U * 11 * 3);
  for (int y = 0; y < 11; ++y)
    for (int x = 0; x < 37; ++x) {
      const std::uint8_t* p = &back.bytes[static_cast<std::size_t>(3 * (y * 37 + x))];
      EXPECT_EQ(p[0], x * 6);
      EXPECT_EQ(p[1], y * 20);
      EXPECT_EQ(p[2], x * y % 256);
    }
}

// Alpha is kept where there is any, and colours are those of the thing, not dimmed by it.
TEST_F(WritePng, Alpha) {
  Image image(2, 1);
  image.at(0, 0) = {0.25F, 0.5F, 0, 0.5F};
  const std::string path = folder_ / "a.png";
  writePng(path, image);
  const ReadBack back = readPng(path);
  EXPECT_EQ(back.colorType, PNG_COLOR_TYPE_RGB_ALPHA);
  EXPECT_EQ(back.bytes, (std::vector<std::uint8_t>{188, 255, 0, 128, 0, 0, 0, 0}));
}

TEST_F(WritePng, FilesThatCannotBe) {
  EXPECT_THROW(encodePng(Image()), Error);
  try {
    writePng(folder_ / "missing" / "a.png", Image(1, 1));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Write);
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

} // namespace
} // namespace tetvdb
