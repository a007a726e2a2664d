// SPDX-License-Identifier: Apache-2.0
#include "TemporaryFolder.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/IsolatedRead.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <new>
#include <string>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace tetvdb {
namespace {

class IsolatedRead : public testing::Test {
protected:
  /// The numbers that `ask` returns in a child process.
  std::vector<std::int32_t> inChild(const std::function<std::vector<std::int32_t>()>& ask,
                                    const IsolationLimits& limits = {}) {
    Report report;
    Progress progress;
    const NumberArrays arrays = readArraysIsolated(
        [&](Report&, Progress&) { return NumberArrays{ask()}; }, "file", limits, report, progress);
    return std::get<std::vector<std::int32_t>>(arrays.at(0));
  }
  Status failureOf(const std::function<std::vector<std::int32_t>()>& ask,
                   const IsolationLimits& limits = {}) {
    try {
      inChild(ask, limits);
    } catch (const Error& error) {
      return error.status();
    }
    return Status::Ok;
  }
  TemporaryFolder folder_;
};

TEST_F(IsolatedRead, FilesCanBeRead) {
  std::ofstream(folder_ / "a") << "text";
  EXPECT_EQ(inChild([&]() -> std::vector<std::int32_t> {
              std::string text;
              std::ifstream(folder_ / "a") >> text;
              return {static_cast<std::int32_t>(std::filesystem::file_size(folder_ / "a")),
                      text == "text" ? 1 : 0};
            }),
            (std::vector<std::int32_t>{4, 1}));
}

TEST_F(IsolatedRead, NothingElseOfTheSystem) {
  std::ofstream(folder_ / "a") << "text";
  const std::string file = folder_ / "a", other = folder_ / "b";
  const auto errorOf = [](int result) { return result < 0 ? errno : 0; };
  const std::vector<std::int32_t> errors = inChild([&]() -> std::vector<std::int32_t> {
    return {errorOf(::open(other.c_str(), O_CREAT | O_WRONLY, 0600)),
            errorOf(::open(file.c_str(), O_RDWR)),
            errorOf(::open(file.c_str(), O_RDONLY | O_TRUNC)),
            errorOf(::unlink(file.c_str())),
            errorOf(::rename(file.c_str(), other.c_str())),
            errorOf(::socket(AF_INET, SOCK_STREAM, 0)),
            errorOf(::fork()),
            errorOf(::execl("/bin/true", "true", nullptr)),
            errorOf(::kill(::getppid(), 0))};
  });
  EXPECT_EQ(errors, std::vector<std::int32_t>(9, EPERM));
  EXPECT_EQ(std::filesystem::file_size(file), 4U);
  EXPECT_FALSE(std::filesystem::exists(other));
}

TEST_F(IsolatedRead, WhatDiesIsAnError) {
  using Numbers = std::vector<std::int32_t>;
  EXPECT_EQ(failureOf([]() -> Numbers { std::abort(); }), Status::Invalid);
  EXPECT_EQ(failureOf([]() -> Numbers { ::_exit(0); }), Status::Invalid);
  EXPECT_EQ(failureOf([]() -> Numbers {
              ::raise(SIGKILL);
              return {};
            }),
            Status::Invalid);
  EXPECT_EQ(failureOf([]() -> Numbers { throw Error(Status::Limit, "file", "is too large"); }),
            Status::Limit);
}

#ifndef TETVDB_SANITIZED
TEST_F(IsolatedRead, Limits) {
  const auto grow = []() -> std::vector<std::int32_t> {
    std::vector<std::vector<char>> all;
    for (int i = 0; i < 4096; ++i)
      all.emplace_back(std::size_t(1) << 20, 'x');
    return {static_cast<std::int32_t>(all.size())};
  };
  EXPECT_EQ(failureOf(grow, {std::uint64_t(64) << 20, 0}), Status::Limit);
  const auto spin = []() -> std::vector<std::int32_t> {
    for (volatile int i = 0;; i = i + 1) {
    }
  };
  EXPECT_EQ(failureOf(spin, {0, 1}), Status::Limit);
}
#endif

} // namespace
} // namespace tetvdb
