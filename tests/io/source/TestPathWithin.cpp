// SPDX-License-Identifier: Apache-2.0
#include "TemporaryFolder.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/PathWithin.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <sys/stat.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

class PathWithin : public testing::Test {
protected:
  PathWithin() {
    fs::create_directories(folder_ / "run/data");
    write("run/data/a.vtu");
    write("secret");
  }
  ~PathWithin() override { allowReferencesOutside(false); }

  void write(const std::string& name) { std::ofstream(folder_ / name) << "x"; }

  /// What the error says; "" where there is none.
  std::string refusal(const std::string& name) const {
    try {
      EXPECT_TRUE(fs::is_regular_file(pathWithin(folder_ / "run/list.pvd", name))) << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Invalid);
      return error.what();
    }
    return {};
  }

  TemporaryFolder folder_;
};

TEST_F(PathWithin, FilesOfTheFolder) {
  for (const std::string& name : {std::string("data/a.vtu"), std::string("./data/../data/a.vtu"),
                                  std::string("data\\a.vtu"), folder_ / "run/data/a.vtu"})
    EXPECT_EQ(refusal(name), "") << name;
}

TEST_F(PathWithin, FilesOutside) {
  fs::create_symlink(folder_ / "secret", folder_ / "run/link");
  fs::create_directory_symlink(folder_.path(), folder_ / "run/up");
  for (const std::string& name :
       {std::string("../secret"), std::string("data/../../secret"), std::string("link"),
        std::string("up/secret"), folder_ / "secret", std::string("/etc/passwd")}) {
    EXPECT_NE(refusal(name).find("folder"), std::string::npos) << name;
    allowReferencesOutside(true);
    EXPECT_EQ(refusal(name), "") << name;
    allowReferencesOutside(false);
  }
}

TEST_F(PathWithin, NothingButRegularFiles) {
  ASSERT_EQ(::mkfifo((folder_ / "run/pipe").c_str(), 0600), 0);
  for (const char* name : {"pipe", "data", "gone.vtu", "."})
    EXPECT_NE(refusal(name).find("is missing"), std::string::npos) << name;
  allowReferencesOutside(true);
  EXPECT_NE(refusal("/dev/zero").find("is missing"), std::string::npos);
}

} // namespace
} // namespace tetvdb
