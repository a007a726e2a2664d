// SPDX-License-Identifier: Apache-2.0
#include "TemporaryFolder.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/FileUse.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

void expectRefused(FileUse& files, const std::string& written, const std::string& says) {
  try {
    files.writes(written);
    ADD_FAILURE() << written;
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Usage);
    EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
  }
}

TEST(FileUse, FilesOfTheirOwnAreInOrder) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a") << "a";
  std::ofstream(folder / "b") << "b";
  FileUse files;
  files.reads(folder / "a");
  files.reads(folder / "a");
  files.reads(folder / "missing");
  files.writes(folder / "b");
  files.writes(folder / "c");
  files.writes(folder / "folder/that/is/not/there");
  files.writes("");
  files.reads("");
  files.writes("/dev/null");
  files.writes("/dev/null");
  files.reads("/dev/null");
}

TEST(FileUse, OneFileUnderManyNames) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a") << "a";
  fs::create_directory(folder / "sub");
  fs::create_symlink("a", folder / "symbolic");
  fs::create_hard_link(folder / "a", folder / "hard");
  fs::create_directory_symlink("..", folder / "sub/up");
  for (const std::string name : {"a", "./a", "sub/../a", "sub/up/a", "symbolic", "hard"}) {
    FileUse files;
    files.reads(folder / "a");
    expectRefused(files, folder / name, "input");
    FileUse other;
    other.writes(folder / name);
    EXPECT_THROW(other.reads(folder / "a"), Error);
    expectRefused(other, folder / "a", "two outputs");
  }
}

TEST(FileUse, FilesThatAreNotThereYet) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "sub");
  fs::create_symlink("../new", folder / "sub/dangling");
  fs::create_symlink("sub/dangling", folder / "twice");
  for (const std::string name : {"new", "./new", "sub/../new", "sub/dangling", "twice"}) {
    FileUse files;
    files.writes(folder / "new");
    expectRefused(files, folder / name, "two outputs");
  }
  FileUse files;
  files.writes(folder / "no/folder/new");
  expectRefused(files, folder / "no/folder/../folder/new", "two outputs");
  files.writes(folder / "sub/new");
  fs::create_symlink("round", folder / "round");
  files.writes(folder / "round");
}

} // namespace
} // namespace tetvdb
