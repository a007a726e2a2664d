// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/FileSpool.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/TemporaryFile.h"

#include <cerrno>
#include <cstring>
#include <sys/mman.h>
#include <unistd.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kBuffer = std::size_t(1) << 18;

} // namespace

FileSpool::FileSpool(std::string folder) : folder_(folder.empty() ? "." : std::move(folder)) {}

FileSpool::~FileSpool() {
  if (map_ != nullptr)
    ::munmap(map_, static_cast<std::size_t>(size_));
  if (descriptor_ >= 0)
    ::close(descriptor_);
}

void FileSpool::append(const void* data, std::size_t size) {
  if (buffer_.size() + size > kBuffer)
    flush();
  if (size >= kBuffer) {
    writeAt(size_, static_cast<const char*>(data), size);
    size_ += size;
    return;
  }
  buffer_.append(static_cast<const char*>(data), size);
  size_ += size;
}

void FileSpool::overwrite(std::uint64_t at, const void* data, std::size_t size) {
  flush();
  writeAt(at, static_cast<const char*>(data), size);
}

void FileSpool::clear() {
  buffer_.clear();
  size_ = 0;
}

void FileSpool::finish() {
  if (size_ == 0 || map_ != nullptr)
    return;
  flush();
  std::string().swap(buffer_);
  void* map =
      ::mmap(nullptr, static_cast<std::size_t>(size_), PROT_READ, MAP_SHARED, descriptor_, 0);
  if (map == MAP_FAILED)
    fail("cannot map a temporary file", errno);
  map_ = map;
}

void FileSpool::swap(FileSpool& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(buffer_, other.buffer_);
  std::swap(size_, other.size_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(map_, other.map_);
}

void FileSpool::release() const noexcept {
  if (map_ != nullptr)
    ::madvise(map_, static_cast<std::size_t>(size_), MADV_DONTNEED);
}

void FileSpool::open() {
  descriptor_ = createUnnamedFile(folder_);
  if (descriptor_ < 0)
    fail("cannot create a temporary file", errno);
}

void FileSpool::flush() {
  if (buffer_.empty())
    return;
  writeAt(size_ - buffer_.size(), buffer_.data(), buffer_.size());
  buffer_.clear();
}

void FileSpool::writeAt(std::uint64_t at, const char* data, std::size_t size) {
  if (descriptor_ < 0)
    open();
  if (!writeAllAt(descriptor_, at, data, size))
    fail("cannot write a temporary file", errno);
}

void FileSpool::fail(const char* what, int error) const {
  throw Error(Status::Write, folder_, std::string(what) + ": " + std::strerror(error),
              error == ENOSPC ? "free some space or write elsewhere; nothing was left behind" : "");
}

} // namespace tetvdb
