// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/AtomicFile.h"

#include "tetvdb/core/Error.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
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

} // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
  struct stat info {};
  if (::stat(path_.c_str(), &info) == 0 && S_ISDIR(info.st_mode))
    fail("is a directory", 0);
  temporary_ = path_ + ".tmp" + std::to_string(::getpid());
  descriptor_ = ::open(temporary_.c_str(), O_CREAT | O_TRUNC | O_RDWR | O_CLOEXEC, 0666);
  if (descriptor_ < 0)
    fail("cannot create the file", errno);
  buffer_.reserve(kBufferBytes);
  remember(temporary_.c_str());
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0)
    return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
  forget(temporary_.c_str());
}

void AtomicFile::fail(const char* what, int error) const {
  std::string text(what);
  if (error != 0)
    (text += ": ") += std::strerror(error);
  throw Error(Status::Write, path_, text,
              error == ENOSPC ? "free some space or write elsewhere; nothing was left behind"
                              : "choose another output with -o");
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

void AtomicFile::commit() {
  flush();
  // Some file systems cannot sync (EINVAL); that is no failure to write.
  if (::fsync(descriptor_) != 0 && errno != EINVAL)
    fail("cannot write", errno);
  const int descriptor = std::exchange(descriptor_, -1);
  const bool closed = ::close(descriptor) == 0;
  const int error = closed && std::rename(temporary_.c_str(), path_.c_str()) == 0 ? 0 : errno;
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
