// SPDX-License-Identifier: Apache-2.0
#include "FileBytes.h"
#include "TemporaryFolder.h"
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/TemporaryFile.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <unistd.h>
#include <vector>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> namesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(AtomicFile, IsAbsentUntilItIsCommitted) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.txt";
  {
    AtomicFile file(path);
    file.write("hello", 5);
    EXPECT_FALSE(fs::exists(path));
  }
  EXPECT_TRUE(namesIn(folder.path()).empty());
  AtomicFile file(path);
  file.write("hello", 5);
  file.writeAt(1, "a", 1);
  file.commit();
  EXPECT_EQ(test::fileBytes(path), "hallo");
  EXPECT_EQ(namesIn(folder.path()), std::vector<std::string>{"a.txt"});
}

TEST(AtomicFile, KeepsTheOldFileUntilItIsCommitted) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.txt";
  std::ofstream(path) << "old";
  {
    AtomicFile file(path);
    file.write("new", 3);
    EXPECT_EQ(test::fileBytes(path), "old");
  }
  EXPECT_EQ(test::fileBytes(path), "old");
}

TEST(TemporaryFile, NamesAreNeverTheSame) {
  const TemporaryFolder folder;
  std::set<std::string> seen;
  for (int i = 0; i < 200; ++i) {
    std::string path;
    const int file = createTemporaryFile(folder.path().string(), "a.txt", 0600, path);
    ASSERT_GE(file, 0);
    ::close(file);
    EXPECT_TRUE(seen.insert(path).second);
  }
  EXPECT_EQ(namesIn(folder.path()).size(), seen.size());
}

TEST(TemporaryFile, HasNoNameUntilItGetsOne) {
  const TemporaryFolder folder;
  const int file = createFileToName(folder.path().string(), 0640);
  if (file < 0)
    GTEST_SKIP() << "the file system knows no files without a name";
  ASSERT_EQ(::write(file, "hello", 5), 5);
  EXPECT_TRUE(namesIn(folder.path()).empty());
  std::string path;
  EXPECT_FALSE(nameFile(file, folder / "no", "a.txt", path));
  ASSERT_TRUE(nameFile(file, folder.path().string(), "a.txt", path)) << errno;
  ::close(file);
  EXPECT_EQ(test::fileBytes(path), "hello");
  EXPECT_EQ(namesIn(folder.path()), std::vector<std::string>{fs::path(path).filename().string()});
}

TEST(AtomicFile, TwoWritersOfOneFileDoNotMixTheirBytes) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.txt";
  AtomicFile first(path), second(path);
  first.write("first", 5);
  second.write("second", 6);
  first.commit();
  EXPECT_EQ(test::fileBytes(path), "first");
  second.commit();
  EXPECT_EQ(test::fileBytes(path), "second");
}

TEST(AtomicFile, LargeFilesArriveWhole) {
  const TemporaryFolder folder;
  std::string bytes(5000001, ' ');
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<char>(i * 2654435761u >> 24);
  AtomicFile file(folder / "a.bin");
  for (std::size_t at = 0; at < bytes.size(); at += 777777)
    file.write(bytes.data() + at, std::min<std::size_t>(777777, bytes.size() - at));
  file.commit();
  EXPECT_EQ(test::fileBytes(folder / "a.bin"), bytes);
}

TEST(AtomicFile, FoldersAreRefused) {
  const TemporaryFolder folder;
  for (const std::string& path : {folder.path().string(), folder / "no/such/folder", folder / ""}) {
    try {
      const AtomicFile file(path);
      ADD_FAILURE() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Write);
    }
  }
}

} // namespace
} // namespace tetvdb
