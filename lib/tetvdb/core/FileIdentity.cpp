// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/FileIdentity.h"

#include <cerrno>
#include <climits>
#include <filesystem>
#include <sys/stat.h>
#include <unistd.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxLinks = 40; // as the kernel

FileIdentity identityOf(const struct stat& info) {
  FileIdentity identity;
  identity.device = info.st_dev;
  identity.inode = info.st_ino;
  identity.isDevice = S_ISCHR(info.st_mode);
  return identity;
}

} // namespace

std::string followLinks(const std::string& path) {
  fs::path at(path);
  for (int i = 0; i < kMaxLinks; ++i) {
    char target[PATH_MAX];
    const ssize_t size = ::readlink(at.c_str(), target, sizeof target);
    if (size < 0)
      return at.string();
    // An absolute target replaces all before it.
    at = at.parent_path() / std::string(target, static_cast<std::size_t>(size));
  }
  errno = ELOOP;
  return {};
}

FileIdentity identify(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0)
    return identityOf(info);
  const fs::path target(followLinks(path));
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  FileIdentity identity;
  if (::stat(folder.c_str(), &info) == 0) {
    identity.device = info.st_dev;
    identity.inode = info.st_ino;
    identity.name = target.filename().string();
  } else {
    std::error_code ignored;
    identity.name = fs::weakly_canonical(target, ignored).string();
  }
  return identity;
}

FileIdentity identify(int descriptor) {
  struct stat info {};
  return ::fstat(descriptor, &info) == 0 ? identityOf(info) : FileIdentity();
}

} // namespace tetvdb
