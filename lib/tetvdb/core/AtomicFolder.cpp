// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/AtomicFolder.h"

#include "tetvdb/core/Error.h"

#include <cerrno>
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

// Removes a folder of files without allocating: memory may have run out.
void removeFiles(const char* path) noexcept {
  const int folder = ::open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  for (bool any = folder >= 0; any;) {
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
  if (folder >= 0)
    ::close(folder);
  ::rmdir(path);
}

} // namespace

AtomicFolder::AtomicFolder(std::string path, const Contents& contents) : path_(std::move(path)) {
  while (path_.size() > 1 && path_.back() == '/')
    path_.pop_back();
  std::error_code error;
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
}

AtomicFolder::~AtomicFolder() {
  if (temporary_.empty())
    return;
  removeFiles(temporary_.c_str());
}

void AtomicFolder::commit() {
  const int folder = ::open(temporary_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0 || ::syncfs(folder) != 0)
    failWrite(path_, "cannot write");
  ::close(folder);
  const mode_t mask = ::umask(0);
  ::umask(mask);
  ::chmod(temporary_.c_str(), 0777 & ~mask);
  std::error_code error;
  std::string old;
  if (fs::exists(path_)) {
    old = makeBeside(path_);
    fs::rename(path_, old, error);
    if (error) {
      fs::remove(old, error);
      throw Error(Status::Write, path_, "cannot be replaced");
    }
  }
  fs::rename(temporary_, path_, error);
  if (error) {
    if (!old.empty()) {
      std::error_code ignored;
      fs::rename(old, path_, ignored);
    }
    throw Error(Status::Write, path_, "cannot create the folder: " + error.message());
  }
  temporary_.clear();
  if (!old.empty())
    fs::remove_all(old, error);
}

} // namespace tetvdb
