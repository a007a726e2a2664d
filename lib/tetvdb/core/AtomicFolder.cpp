// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/AtomicFolder.h"

#include "tetvdb/core/Error.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dirent.h>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void failWrite(const std::string& path, const char* what) {
  throw Error(Status::Write, path, fmt::format("{}: {}", what, std::strerror(errno)));
}

// A new folder beside `path`.
std::string makeBeside(const fs::path& path) {
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::string pattern = (parent / ("." + path.filename().string() + ".XXXXXX")).string();
  if (::mkdtemp(pattern.data()) == nullptr)
    failWrite(path.string(), "cannot create a folder beside it");
  return pattern;
}

int openFolder(const std::string& path) {
  return ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

// Removes a folder of files, and closes it. Neither allocates nor opens anything: memory or
// descriptors may have run out.
void removeFiles(int folder, const std::string& path) noexcept {
  for (bool any = true; any;) {
    any = false;
    ::lseek(folder, 0, SEEK_SET);
    alignas(dirent64) char entries[4096];
    for (ssize_t size; (size = ::getdents64(folder, entries, sizeof entries)) > 0;)
      for (ssize_t at = 0; at < size;) {
        const auto* entry = reinterpret_cast<const dirent64*>(entries + at);
        any = ::unlinkat(folder, entry->d_name, 0) == 0 || any;
        at += entry->d_reclen;
      }
  }
  ::close(folder);
  ::rmdir(path.c_str());
}

// Gives `from` the name `to`, and the folder of that name the name `from`. In one step where the
// file system can exchange names.
bool exchangeNames(const std::string& from, const std::string& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_EXCHANGE) == 0)
    return true;
  if (errno != EINVAL && errno != ENOSYS)
    return false;
  const std::string beside = makeBeside(to);
  if (::rename(to.c_str(), beside.c_str()) != 0) {
    const int error = errno;
    ::rmdir(beside.c_str());
    errno = error;
    return false;
  }
  if (::rename(from.c_str(), to.c_str()) != 0) {
    const int error = errno;
    ::rename(beside.c_str(), to.c_str());
    errno = error;
    return false;
  }
  return ::rename(beside.c_str(), from.c_str()) == 0;
}

} // namespace

AtomicFolder::AtomicFolder(std::string path, const Contents& contents) : path_(std::move(path)) {
  while (path_.size() > 1 && path_.back() == '/')
    path_.pop_back();
  std::error_code error;
  if (fs::is_symlink(path_, error))
    path_ = fs::weakly_canonical(path_).string(); // what the link names is replaced
  const fs::file_status status = fs::status(path_, error);
  if (fs::exists(status)) {
    if (!fs::is_directory(status))
      throw Error(Status::Usage, path_,
                  "is a file; a folder of " + contents.things + " cannot replace it",
                  "choose another name");
    bool any = false, index = false;
    for (const fs::directory_entry& entry : fs::directory_iterator(path_, error)) {
      any = true;
      const std::string name = entry.path().filename().string();
      const bool isIndex = name == contents.index;
      index = index || isIndex;
      if (!(isIndex || contents.isOurs(name)) || !entry.is_regular_file())
        throw Error(Status::Usage, path_, "is a folder with other files in it, such as " + name,
                    "choose a new folder");
    }
    if (error || (any && !index))
      throw Error(Status::Usage, path_,
                  "is a folder that holds no " + contents.things + " of this program",
                  "choose a new folder");
  }
  temporary_ = makeBeside(path_);
  folder_ = openFolder(temporary_);
  if (folder_ < 0) {
    ::rmdir(temporary_.c_str());
    failWrite(path_, "cannot create a folder beside it");
  }
}

AtomicFolder::~AtomicFolder() {
  if (folder_ >= 0)
    removeFiles(folder_, temporary_);
}

void AtomicFolder::commit() {
  if (::syncfs(folder_) != 0)
    failWrite(path_, "cannot write");
  const mode_t mask = ::umask(0);
  ::umask(mask);
  ::fchmod(folder_, 0777 & ~mask);
  const int old = openFolder(path_); // before it is too late for an error
  if (old < 0 && errno != ENOENT)
    failWrite(path_, "cannot be replaced");
  const bool renamed =
      old < 0 ? ::rename(temporary_.c_str(), path_.c_str()) == 0 : exchangeNames(temporary_, path_);
  if (!renamed) {
    const int error = errno;
    if (old >= 0)
      ::close(old);
    errno = error;
    failWrite(path_, old < 0 ? "cannot create the folder" : "cannot be replaced");
  }
  ::close(std::exchange(folder_, -1));
  if (old >= 0)
    removeFiles(old, temporary_);
}

} // namespace tetvdb
