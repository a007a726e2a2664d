// SPDX-License-Identifier: Apache-2.0
//
// What is compressed block by block is what Blosc makes of the whole.
#include "FileBytes.h"
#include "TemporaryFolder.h"
#include "tetvdb/io/volume/BloscChunks.h"

#include <algorithm>
#include <blosc.h>
#include <cstring>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kBlock = std::size_t(1) << 20; // Blosc's own, larger than asked for

// Written in steps of any size; without the number of bytes before it.
std::string chunk(const std::vector<unsigned char>& data, std::mt19937& random) {
  const TemporaryFolder folder;
  AtomicFile file(folder / "a");
  BloscChunks chunks(file, data.size());
  for (std::size_t done = 0; done < data.size();) {
    const std::size_t step = std::min<std::size_t>(data.size() - done, 1 + random() % (3 * kBlock));
    chunks.write(data.data() + done, step);
    done += step;
  }
  file.commit();
  const std::string bytes = test::fileBytes(folder / "a");
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data(), sizeof size);
  EXPECT_EQ(size, bytes.size() - sizeof size);
  return bytes.substr(sizeof size);
}

std::string byBlosc(const std::vector<unsigned char>& data) {
  std::string packed(data.size() + BLOSC_MAX_OVERHEAD, '\0');
  const int count =
      blosc_compress_ctx(9, BLOSC_SHUFFLE, sizeof(float), data.size(), data.data(), packed.data(),
                         packed.size(), "lz4", BloscChunks::kAskedBlock, 1);
  EXPECT_GT(count, 0);
  packed.resize(static_cast<std::size_t>(count));
  return packed;
}

TEST(BloscChunks, HaveTheBytesOfTheWhole) {
  std::mt19937 random(5);
  for (const std::size_t size :
       {std::size_t(1), std::size_t(100), std::size_t(128), std::size_t(5000), kBlock - 1, kBlock,
        kBlock + 1, kBlock + 31, kBlock + 200, kBlock / 4, 3 * kBlock, 17 * kBlock + 4096,
        16 * kBlock}) {
    std::vector<unsigned char> data(size);
    for (std::size_t i = 0; i < size; ++i) // runs, and every eighth block without any
      data[i] = static_cast<unsigned char>(i / kBlock % 8 == 7 ? random() : i / 37 % 5 * (i % 4));
    EXPECT_TRUE(chunk(data, random) == byBlosc(data)) << size;
  }
}

TEST(BloscChunks, OfWhatCannotBeCompressedCanBeRead) {
  std::mt19937 random(6);
  for (const std::size_t size : {std::size_t(1000), kBlock, 5 * kBlock + 99}) {
    std::vector<unsigned char> data(size), read(size);
    std::generate(data.begin(), data.end(), [&] { return static_cast<unsigned char>(random()); });
    const std::string packed = chunk(data, random);
    EXPECT_LT(packed.size(), data.size() + data.size() / 8192 + 100);
    EXPECT_EQ(blosc_decompress_ctx(packed.data(), read.data(), size, 1), static_cast<int>(size));
    EXPECT_TRUE(read == data) << size;
  }
}

} // namespace
} // namespace tetvdb
