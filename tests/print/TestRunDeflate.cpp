// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/HuffmanLengths.h"
#include "tetvdb/print/LayerPng.h"
#include "tetvdb/print/RunDeflate.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <png.h>
#include <random>
#include <zlib.h>

namespace tetvdb {
namespace {

using Runs = std::vector<std::pair<int, std::size_t>>;

std::string unpacked(const std::string& stream, std::size_t size) {
  std::string bytes(size + 1, '?');
  auto length = static_cast<uLongf>(bytes.size());
  const int status =
      uncompress(reinterpret_cast<Bytef*>(bytes.data()), &length,
                 reinterpret_cast<const Bytef*>(stream.data()), static_cast<uLong>(stream.size()));
  EXPECT_EQ(status, Z_OK);
  bytes.resize(length);
  return bytes;
}

void expectUnpacked(const Runs& runs) {
  RunDeflate stream;
  std::string bytes;
  for (const auto& [value, count] : runs) {
    stream.add(static_cast<std::uint8_t>(value), count);
    bytes.append(count, static_cast<char>(value));
  }
  EXPECT_TRUE(unpacked(stream.finish(), bytes.size()) == bytes);
}

TEST(RunDeflate, RunsOfEveryLength) {
  for (std::size_t length = 0; length < 600; ++length)
    expectUnpacked({{7, length}, {0, 1}});
  for (const std::size_t length : {258u * 15, 258u * 16, 258u * 17, 258u * 16 + 1, 258u * 4001 + 5})
    expectUnpacked({{9, 1}, {0, length}, {255, length}});
  expectUnpacked({});
}

TEST(RunDeflate, RandomRuns) {
  std::mt19937 random(5);
  for (int i = 0; i < 60; ++i) {
    Runs runs;
    const int values = i % 3 == 0 ? 2 : 256;
    for (std::size_t n = random() % 2000; n > 0; --n)
      runs.emplace_back(int(random() % unsigned(values)),
                        random() % (random() % 10 == 0 ? 20000 : 4));
    expectUnpacked(runs);
  }
}

// Counts like Fibonacci's numbers ask for words of more than 15 bits.
TEST(RunDeflate, WordsAreLimited) {
  Runs runs;
  std::size_t a = 1, b = 1;
  for (int value = 0; value < 24; ++value) {
    for (std::size_t i = 0; i < a; ++i)
      runs.emplace_back(value, 1), runs.emplace_back(200, 1);
    b = std::exchange(a, a + b);
  }
  expectUnpacked(runs);
}

TEST(RunDeflate, TakesTwoBitsForTheLongestMatch) {
  RunDeflate stream;
  const std::uint64_t size = 258u * 1000000;
  stream.add(0, size);
  EXPECT_LT(stream.finish().size(), 1000000 / 4 + 100);
}

TEST(RunDeflate, SameBytesHoweverRunsAreCut) {
  RunDeflate whole, cut;
  whole.add(3, 1000);
  for (int i = 0; i < 1000; ++i)
    cut.add(3, 1);
  EXPECT_TRUE(whole.finish() == cut.finish());
}

TEST(RunAdler, IsZlibs) {
  std::mt19937 random(6);
  RunAdler sum;
  uLong expected = adler32(0, nullptr, 0);
  for (int i = 0; i < 100; ++i) {
    const auto value = static_cast<std::uint8_t>(random());
    const std::string bytes(random() % 200000, static_cast<char>(value));
    sum.add(value, bytes.size());
    expected = adler32(expected, reinterpret_cast<const Bytef*>(bytes.data()),
                       static_cast<uInt>(bytes.size()));
  }
  EXPECT_EQ(sum.sum(), expected);
}

// Against every code of few symbols.
TEST(HuffmanLengths, AreOptimal) {
  std::mt19937 random(9);
  for (int i = 0; i < 200; ++i) {
    std::vector<std::uint64_t> counts(5);
    for (std::uint64_t& count : counts)
      count = 1 + random() % 40;
    const int limit = 3 + i % 2;
    std::uint64_t best = ~std::uint64_t(0);
    for (int code = 0; code < 1024; ++code) { // two bits a symbol: its length less one
      unsigned room = 0;
      std::uint64_t bits = 0;
      for (std::size_t s = 0; s < 5; ++s) {
        const unsigned length = 1 + (unsigned(code) >> (2 * s) & 3);
        if (length > unsigned(limit))
          room = 1000;
        room += 16u >> length;
        bits += counts[s] * length;
      }
      if (room <= 16)
        best = std::min(best, bits);
    }
    const std::vector<std::uint8_t> lengths = huffmanLengths(counts, limit);
    std::uint64_t bits = 0;
    for (std::size_t s = 0; s < 5; ++s) {
      EXPECT_LE(lengths[s], limit);
      bits += counts[s] * lengths[s];
    }
    EXPECT_EQ(bits, best);
  }
}

// libpng reads what was written.
TEST(LayerPng, IsReadByLibpng) {
  std::mt19937 random(4);
  for (int i = 0; i < 30; ++i) {
    const int width = 1 + int(random() % 300), height = 1 + int(random() % 40);
    std::vector<std::uint8_t> pixels(std::size_t(width) * std::size_t(height), 0);
    Layer layer;
    for (int y = 0; y < height; ++y) {
      if (random() % 3 == 0)
        continue;
      for (int x = 0; x < width;) {
        const int end = std::min(width, x + 1 + int(random() % 30));
        const auto value = static_cast<std::uint8_t>(random() % 2 == 0 ? random() : 0);
        layer.add(y, x, end, value);
        std::fill(pixels.begin() + y * width + x, pixels.begin() + y * width + end, value);
        x = end;
      }
    }
    const std::string file = encodeLayerPng(layer, width, height);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    ASSERT_NE(png_image_begin_read_from_memory(&png, file.data(), file.size()), 0);
    EXPECT_EQ(png.width, unsigned(width));
    EXPECT_EQ(png.height, unsigned(height));
    EXPECT_EQ(png.format, unsigned(PNG_FORMAT_GRAY));
    png.format = PNG_FORMAT_GRAY;
    std::vector<std::uint8_t> read(PNG_IMAGE_SIZE(png));
    ASSERT_NE(png_image_finish_read(&png, nullptr, read.data(), 0, nullptr), 0);
    EXPECT_TRUE(read == pixels);
  }
}

} // namespace
} // namespace tetvdb
