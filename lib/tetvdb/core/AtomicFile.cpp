// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/AtomicFile.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/FileIdentity.h"
#include "tetvdb/core/TemporaryFile.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kBufferBytes = std::size_t(1) << 20;

// Names of open temporary files, for removeTemporaryFiles(). A slot is claimed by its atomic
// pointer; the characters it points to stay valid until the slot is cleared again.
std::array<std::atomic<const char*>, 64> openTemporaries{};

void remember(const char* name) {
  for (auto& slot : openTemporaries) {
    const char* expected = nullptr;
    if (slot.compare_exchange_strong(expected, name))
      return;
  }
}

void forget(const char* name) {
  for (auto& slot : openTemporaries) {
    const char* expected = name;
    if (slot.compare_exchange_strong(expected, nullptr))
      return;
  }
}

void writeFully(int descriptor, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t done = ::write(descriptor, data, size);
    if (done < 0) {
      if (errno == EINTR)
        continue;
      throw errno;
    }
    data += done;
    size -= static_cast<std::size_t>(done);
  }
}

// Standard output or standard error where that is the file, open for writing; -1 where neither is.
int standardStream(const struct stat& info) {
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
    struct stat other {};
    const int flags = ::fcntl(stream, F_GETFL);
    if (flags >= 0 && (flags & O_ACCMODE) != O_RDONLY && ::fstat(stream, &other) == 0 &&
        other.st_dev == info.st_dev && other.st_ino == info.st_ino)
      return stream;
  }
  return -1;
}

int connectSocket(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return -1;
  }
  path.copy(address.sun_path, path.size());
  const int stream = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (stream >= 0 &&
      ::connect(stream, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const int error = errno;
    ::close(stream);
    errno = error;
    return -1;
  }
  return stream;
}

// Open for writing, at the end of what is there; -1 with errno set where it cannot be, or has
// become a regular file.
int openStream(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0)
    return -1;
  const int standard = standardStream(info);
  if (standard >= 0)
    return ::fcntl(standard, F_DUPFD_CLOEXEC, 3);
  if (S_ISSOCK(info.st_mode))
    return connectSocket(path);
  const int stream = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  if (stream >= 0 && ::fstat(stream, &info) == 0 && S_ISREG(info.st_mode)) {
    ::close(stream);
    errno = EEXIST;
    return -1;
  }
  return stream;
}

// Folder and name.
std::pair<std::string, std::string> parted(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos)
    return {".", path};
  return {path.substr(0, slash + 1), path.substr(slash + 1)};
}

// Owner, group and permissions of `target` for the file that will take its place. Where the group
// cannot be given, neither are its rights.
void takePermissions(const std::string& target, int descriptor) {
  struct stat info {
  }, own{};
  if (::stat(target.c_str(), &info) != 0 || ::fstat(descriptor, &own) != 0)
    return;
  mode_t mode = info.st_mode & 0777;
  const bool given = ::fchown(descriptor, info.st_uid, info.st_gid) == 0 ||
                     ::fchown(descriptor, uid_t(-1), info.st_gid) == 0;
  if (!given && own.st_gid != info.st_gid)
    mode &= 0707u;
  ::fchmod(descriptor, mode);
}

} // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
  struct stat info {};
  const bool exists = ::stat(path_.c_str(), &info) == 0;
  if (!exists && errno != ENOENT)
    fail("cannot create the file", errno);
  if (exists && S_ISDIR(info.st_mode))
    fail("is a directory", 0);
  if (exists && ::faccessat(AT_FDCWD, path_.c_str(), W_OK, AT_EACCESS) != 0)
    fail("cannot write", errno);
  if (exists && (!S_ISREG(info.st_mode) || standardStream(info) >= 0)) {
    const char* folder = std::getenv("TMPDIR");
    descriptor_ = createUnnamedFile(folder != nullptr && *folder != 0 ? folder : "/tmp");
    if (descriptor_ < 0)
      fail("cannot create a temporary file", errno);
  } else {
    createBeside(followLinks(path_), exists);
  }
  buffer_.reserve(kBufferBytes);
}

void AtomicFile::createBeside(const std::string& target, bool exists) {
  if (target.empty())
    fail("cannot create the file", errno);
  target_ = target;
  const auto [folder, base] = parted(target);
  if (base.empty())
    fail("cannot create the file", EISDIR);
  const mode_t mode = exists ? 0600 : 0666;
  descriptor_ = createFileToName(folder, mode);
  if (descriptor_ < 0) {
    descriptor_ = createTemporaryFile(folder, base, mode, temporary_);
    if (descriptor_ < 0)
      fail("cannot create the file", errno);
    remember(temporary_.c_str());
  }
  if (exists)
    takePermissions(target, descriptor_);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0)
    return;
  ::close(descriptor_);
  if (temporary_.empty())
    return;
  ::unlink(temporary_.c_str());
  forget(temporary_.c_str());
}

void AtomicFile::fail(const char* what, int error) const {
  std::string text(what);
  if (error != 0)
    (text += ": ") += std::strerror(error);
  throw Error(Status::Write, path_, text,
              error == ENOSPC ? "free some space or write elsewhere; nothing was left behind"
                              : "write elsewhere");
}

void AtomicFile::flush() {
  try {
    writeFully(descriptor_, buffer_.data(), buffer_.size());
  } catch (int error) {
    fail("cannot write", error);
  }
  buffer_.clear();
}

void AtomicFile::write(const void* data, std::size_t size) {
  size_ += size;
  if (buffer_.size() + size > kBufferBytes)
    flush();
  if (size < kBufferBytes) {
    buffer_.append(static_cast<const char*>(data), size);
    return;
  }
  try {
    writeFully(descriptor_, static_cast<const char*>(data), size);
  } catch (int error) {
    fail("cannot write", error);
  }
}

void AtomicFile::writeAt(std::uint64_t offset, const void* data, std::size_t size) {
  flush();
  const char* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t done = ::pwrite(descriptor_, bytes, size, static_cast<off_t>(offset));
    if (done < 0) {
      if (errno == EINTR)
        continue;
      fail("cannot write", errno);
    }
    bytes += done;
    offset += static_cast<std::uint64_t>(done);
    size -= static_cast<std::size_t>(done);
  }
}

void AtomicFile::readAt(std::uint64_t offset, void* data, std::size_t size) const {
  char* bytes = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t got = ::pread(descriptor_, bytes, size, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR)
      continue;
    if (got <= 0)
      fail("cannot read back what was written", got < 0 ? errno : EIO);
    bytes += got;
    offset += static_cast<std::uint64_t>(got);
    size -= static_cast<std::size_t>(got);
  }
}

std::string AtomicFile::nameForLibraries() {
  flush();
  foreign_ = true;
  if (target_.empty())
    return "/proc/self/fd/" + std::to_string(descriptor_);
  // A link in /proc to a file that was made without a name leads to a path that is not there, and
  // HDF5 asks for that path.
  giveName();
  return temporary_;
}

void AtomicFile::commit() {
  flush();
  if (foreign_)
    size_ = static_cast<std::uint64_t>(std::max<off_t>(::lseek(descriptor_, 0, SEEK_END), 0));
  if (target_.empty())
    send();
  else
    replace();
}

void AtomicFile::send() {
  const int stream = openStream(path_);
  if (stream < 0)
    fail("cannot write", errno);
  int error = 0;
  try {
    for (std::uint64_t at = 0; at < size_;) {
      buffer_.resize(kBufferBytes);
      const ssize_t got =
          ::pread(descriptor_, buffer_.data(), buffer_.size(), static_cast<off_t>(at));
      if (got < 0 && errno == EINTR)
        continue;
      if (got <= 0)
        throw got < 0 ? errno : EIO;
      writeFully(stream, buffer_.data(), static_cast<std::size_t>(got));
      at += static_cast<std::uint64_t>(got);
    }
  } catch (int failed) {
    error = failed;
  }
  if (::close(stream) != 0 && error == 0)
    error = errno;
  if (error != 0)
    fail("cannot write", error);
  ::close(std::exchange(descriptor_, -1));
}

void AtomicFile::giveName() {
  if (!temporary_.empty())
    return;
  const auto [folder, base] = parted(target_);
  std::string name;
  if (!nameFile(descriptor_, folder, base, name))
    fail("cannot write", errno);
  temporary_ = std::move(name);
  remember(temporary_.c_str());
}

void AtomicFile::replace() {
  // Some file systems cannot sync (EINVAL); that is no failure to write.
  if (::fsync(descriptor_) != 0 && errno != EINVAL)
    fail("cannot write", errno);
  if (temporary_.empty() && nameNewFile(descriptor_, target_)) {
    ::close(std::exchange(descriptor_, -1));
    return;
  }
  giveName();
  const int descriptor = std::exchange(descriptor_, -1);
  const bool closed = ::close(descriptor) == 0;
  const int error = closed && std::rename(temporary_.c_str(), target_.c_str()) == 0 ? 0 : errno;
  if (error != 0)
    ::unlink(temporary_.c_str());
  forget(temporary_.c_str());
  if (error != 0)
    fail("cannot write", error);
}

void removeTemporaryFiles() noexcept {
  for (auto& slot : openTemporaries)
    if (const char* name = slot.load())
      ::unlink(name);
}

} // namespace tetvdb
