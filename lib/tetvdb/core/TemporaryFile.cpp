// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/TemporaryFile.h"

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <sys/random.h>
#include <unistd.h>

namespace tetvdb {
namespace {

constexpr int kTries = 100;
constexpr std::size_t kRandomLetters = 12; // 60 bits
constexpr std::size_t kLongestBase = 200;  // names have at most 255 bytes

// Empty, with errno set, where the system gives no random numbers.
std::string randomLetters() {
  std::array<unsigned char, kRandomLetters> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    return {};
  std::string text;
  for (const unsigned char byte : bytes)
    text += "abcdefghijklmnopqrstuvwxyz234567"[byte & 31];
  return text;
}

// Puts names into `path` until `make` makes a file of one: what it returned, -1 where it failed.
template <class Make>
int underRandomName(const std::string& folder, const std::string& base, std::string& path,
                    const Make& make) {
  for (int i = 0; i < kTries; ++i) {
    const std::string random = randomLetters();
    if (random.empty())
      return -1;
    path = folder + "/." + base.substr(0, kLongestBase) + "." + random + ".tmp";
    const int made = make(path.c_str());
    if (made >= 0 || errno != EEXIST)
      return made;
  }
  return -1;
}

std::string linkTo(int descriptor) {
  return "/proc/self/fd/" + std::to_string(descriptor);
}

} // namespace

int createTemporaryFile(const std::string& folder, const std::string& base, mode_t mode,
                        std::string& path) {
  return underRandomName(folder, base, path, [&](const char* name) {
    return ::open(name, O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC | O_RDWR, mode);
  });
}

int createFileToName(const std::string& folder, mode_t mode) {
#ifdef O_TMPFILE
  const int unnamed = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, mode);
  if (unnamed >= 0 && ::access(linkTo(unnamed).c_str(), F_OK) == 0)
    return unnamed;
  if (unnamed >= 0) // without /proc it would stay without a name
    ::close(unnamed);
#endif
  return -1;
}

bool nameNewFile(int descriptor, const std::string& path) {
  return ::linkat(AT_FDCWD, linkTo(descriptor).c_str(), AT_FDCWD, path.c_str(),
                  AT_SYMLINK_FOLLOW) == 0;
}

bool nameFile(int descriptor, const std::string& folder, const std::string& base,
              std::string& path) {
  return underRandomName(folder, base, path, [&](const char* name) {
           return ::linkat(AT_FDCWD, linkTo(descriptor).c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW);
         }) == 0;
}

int createUnnamedFile(const std::string& folder) {
#ifdef O_TMPFILE
  const int unnamed = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (unnamed >= 0)
    return unnamed;
#endif
  // Some file systems cannot make a file without a name.
  std::string path;
  const int descriptor = createTemporaryFile(folder, "tetvdb", 0600, path);
  if (descriptor >= 0)
    ::unlink(path.c_str());
  return descriptor;
}

bool writeAllAt(int descriptor, std::uint64_t at, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t done = ::pwrite(descriptor, data, size, static_cast<off_t>(at));
    if (done < 0 && errno == EINTR)
      continue;
    if (done == 0)
      errno = ENOSPC;
    if (done <= 0)
      return false;
    data += done;
    at += static_cast<std::uint64_t>(done);
    size -= static_cast<std::size_t>(done);
  }
  return true;
}

} // namespace tetvdb
