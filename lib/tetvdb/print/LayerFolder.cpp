// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/LayerFolder.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
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

constexpr const char* kManifest = "manifest.json";

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

} // namespace

LayerFolder::LayerFolder(std::string path, std::string_view stem, std::string_view ending)
    : path_(std::move(path)), stem_(stem), ending_(ending) {
  while (path_.size() > 1 && path_.back() == '/')
    path_.pop_back();
  std::error_code error;
  const fs::file_status status = fs::status(path_, error);
  if (fs::exists(status)) {
    if (!fs::is_directory(status))
      throw Error(Status::Usage, path_, "is a file; a folder of layers cannot replace it",
                  "choose another name");
    bool any = false, manifest = false;
    for (const fs::directory_entry& entry : fs::directory_iterator(path_, error)) {
      any = true;
      const std::string name = entry.path().filename().string();
      manifest = manifest || name == kManifest;
      if (!isOurs(name) || !entry.is_regular_file())
        throw Error(Status::Usage, path_, "is a folder with other files in it, such as " + name,
                    "choose a new folder");
    }
    if (error || (any && !manifest))
      throw Error(Status::Usage, path_, "is a folder that holds no layers of this program",
                  "choose a new folder");
  }
  temporary_ = makeBeside(path_);
}

LayerFolder::~LayerFolder() {
  if (temporary_.empty())
    return;
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
}

bool LayerFolder::isOurs(const std::string& name) const {
  if (name == kManifest)
    return true;
  const std::size_t around = stem_.size() + 4; // any ending of three letters
  return name.size() > around && name.compare(0, stem_.size(), stem_) == 0 &&
         std::all_of(name.begin() + static_cast<std::ptrdiff_t>(stem_.size()), name.end() - 4,
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

std::string LayerFolder::nameOf(std::int32_t k) const {
  return fmt::format("{}{:05}{}", stem_, k, ending_);
}

void LayerFolder::write(const std::string& name, std::string_view bytes) {
  const std::string file = temporary_ + "/" + name;
  const int descriptor = ::open(file.c_str(), O_CREAT | O_EXCL | O_CLOEXEC | O_WRONLY, 0666);
  if (descriptor < 0)
    failWrite(path_, "cannot create a file in it");
  const char* at = bytes.data();
  for (std::size_t left = bytes.size(); left > 0;) {
    const ssize_t n = ::write(descriptor, at, left);
    if (n < 0 && errno == EINTR)
      continue;
    if (n < 0) {
      const int why = errno;
      ::close(descriptor);
      errno = why;
      failWrite(path_, "cannot write");
    }
    at += n;
    left -= static_cast<std::size_t>(n);
  }
  if (::close(descriptor) != 0)
    failWrite(path_, "cannot write");
  bytes_ += bytes.size();
}

void LayerFolder::commit() {
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
