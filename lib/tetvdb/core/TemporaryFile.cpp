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

} // namespace

int createTemporaryFile(const std::string& folder, const std::string& base, mode_t mode,
                        std::string& path) {
  for (int i = 0; i < kTries; ++i) {
    const std::string random = randomLetters();
    if (random.empty())
      return -1;
    path = folder + "/." + base.substr(0, kLongestBase) + "." + random + ".tmp";
    const int descriptor =
        ::open(path.c_str(), O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC | O_RDWR, mode);
    if (descriptor >= 0 || errno != EEXIST)
      return descriptor;
  }
  return -1;
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

} // namespace tetvdb
