// SPDX-License-Identifier: Apache-2.0
#include "TemporaryFolder.h"

#include "tetvdb/core/Error.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <new>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace tetvdb::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "tetvdb-report-";

/// The folder with its lock; -1 where another process holds it, or it is not this user's.
int lockFolder(const fs::path& path) {
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0)
    return -1;
  struct stat info {};
  if (::fstat(folder, &info) == 0 && info.st_uid == ::geteuid() && info.st_nlink > 0 &&
      ::flock(folder, LOCK_EX | LOCK_NB) == 0)
    return folder;
  ::close(folder);
  return -1;
}

void removeAbandoned(const fs::path& parent) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(parent, error)) {
    if (entry.path().filename().string().rfind(kPrefix, 0) != 0)
      continue;
    const int folder = lockFolder(entry.path());
    if (folder < 0)
      continue;
    fs::remove_all(entry.path(), error);
    ::close(folder);
  }
}

} // namespace

TemporaryFolder::TemporaryFolder() {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  removeAbandoned(parent);
  // Between its making and its lock another process may take a folder for abandoned.
  for (int i = 0; i < 10 && locked_ < 0; ++i) {
    std::string name = (parent / (kPrefix + std::string("XXXXXX"))).string();
    if (::mkdtemp(name.data()) == nullptr)
      throw Error(Status::Write, name,
                  fmt::format("cannot make a temporary folder: {}", std::strerror(errno)),
                  "set TMPDIR to a folder that can be written to");
    path_ = name;
    locked_ = lockFolder(path_);
    if (locked_ < 0)
      ::rmdir(name.c_str());
  }
  if (locked_ < 0)
    throw Error(Status::Write, parent.string(), "cannot lock a temporary folder",
                "set TMPDIR to a folder that can be written to");
}

TemporaryFolder::~TemporaryFolder() {
  try {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  } catch (const std::bad_alloc&) { // it is removed as an abandoned one
  }
  ::close(locked_);
}

} // namespace tetvdb::cli
