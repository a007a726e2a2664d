// SPDX-License-Identifier: Apache-2.0
#include "Streams.h"

#include "JsonReport.h"
#include "tetvdb/core/Error.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <new>
#include <string>
#include <sys/types.h>
#include <unistd.h>

namespace tetvdb::cli {
namespace {

bool isClosed(int stream) {
  return ::fcntl(stream, F_GETFD) < 0 && errno == EBADF;
}

} // namespace

void openClosedStreams() {
  // A file gets the lowest number that is free. Read-only, so that writing to it fails.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (isClosed(stream) && ::open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY) < 0)
      return;
}

void printMessage(std::string_view text) {
  try {
    writeToStandardError("tetvdb: " + oneLine(std::string(text)) + "\n");
  } catch (const std::bad_alloc&) {
    printOutOfMemory();
  }
}

void printOutOfMemory() {
  constexpr std::string_view kText = "tetvdb: out of memory\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kText.data(), kText.size());
}

void writeToStandardError(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void printResult(std::string_view text) {
  const bool whole = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if ((!whole || std::fflush(stdout) != 0) && errno != EPIPE)
    throw Error(Status::Write, "standard output",
                fmt::format("cannot write: {}", std::strerror(errno)));
}

} // namespace tetvdb::cli
