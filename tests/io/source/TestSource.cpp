// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "tetvdb/io/source/Source.h"

#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <numeric>
#include <string>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace tetvdb {
namespace {

std::string temporaryPath(const char* name) {
  return testing::TempDir() + "tetvdb_" + std::to_string(::getpid()) + "_" + name;
}

std::string openingError(const std::string& path) {
  try {
    const MappedFile file(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Invalid);
    return error.what();
  }
  return {};
}

/// Bytes of memory that this process takes up, by the system.
std::size_t residentBytes() {
  std::size_t size = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> size >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

std::uint64_t sumOf(const Source& source) {
  return std::accumulate(
      source.bytes.begin(), source.bytes.end(), std::uint64_t(0),
      [](std::uint64_t sum, char c) { return sum * 31 + static_cast<unsigned char>(c); });
}

TEST(MappedFile, HoldsTheBytesOfAFile) {
  const MappedFile file(test::dataFile("abaqus_tet.inp"));
  EXPECT_EQ(file.bytes(), test::readFile(test::dataFile("abaqus_tet.inp")));
  EXPECT_EQ(file.source().path, test::dataFile("abaqus_tet.inp"));
}

TEST(MappedFile, MissingEmptyAndDirectory) {
  EXPECT_NE(openingError("/no/such/file.msh").find("/no/such/file.msh: cannot open"),
            std::string::npos);
  EXPECT_NE(openingError(testing::TempDir()).find("is a directory"), std::string::npos);
  const std::string path = temporaryPath("empty");
  std::ofstream(path).flush();
  EXPECT_NE(openingError(path).find("empty"), std::string::npos);
  std::remove(path.c_str());
}

TEST(MappedFile, PointersOfGitLfsAreNamed) {
  const std::string path = temporaryPath("pointer.stl");
  std::ofstream(path)
      << "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";
  EXPECT_NE(openingError(path).find("pointer of Git LFS"), std::string::npos);
  std::remove(path.c_str());
}

TEST(MappedFile, PipesAreReadToTheirEnd) {
  const std::string path = temporaryPath("pipe");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  std::thread writer([&] { std::ofstream(path) << std::string(200000, 'x'); });
  {
    const MappedFile file(path);
    EXPECT_EQ(file.bytes().size(), 200000U);
  }
  writer.join();
  std::remove(path.c_str());
}

TEST(Source, whatWasReadIsGivenBackAndReadAgain) {
  const std::string path = ::testing::TempDir() + "/released." + std::to_string(::getpid());
  constexpr std::size_t kBytes = (std::size_t(24) << 20) + 77;
  {
    std::string text(kBytes, ' ');
    for (std::size_t i = 0; i < kBytes; ++i)
      text[i] = static_cast<char>(i * i >> 7);
    std::ofstream(path, std::ios::binary) << text;
  }
  const MappedFile file(path);
  std::remove(path.c_str());
  const Source source = file.source();
  ASSERT_TRUE(source.isMapped);
  const std::uint64_t sum = sumOf(source);
  const std::size_t full = residentBytes();
  source.release();
  EXPECT_LT(residentBytes() + kBytes * 3 / 4, full);
  EXPECT_EQ(sumOf(source), sum);
}

TEST(Source, bytesOfOthersStay) {
  const std::string text(std::size_t(1) << 16, 'x');
  const Source source{text, "text"};
  EXPECT_FALSE(source.isMapped);
  source.release();
  EXPECT_EQ(source.bytes, std::string(std::size_t(1) << 16, 'x'));
}

} // namespace
} // namespace tetvdb
