// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "tetvdb/io/Source.h"

#include <cstdio>
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

} // namespace
} // namespace tetvdb
