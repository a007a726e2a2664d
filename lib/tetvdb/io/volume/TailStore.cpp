// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/TailStore.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/TemporaryFile.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

namespace tetvdb {

TailStore::TailStore(std::string folder, std::size_t inMemory)
    : folder_(folder.empty() ? "." : std::move(folder)), maxChunks_(inMemory / kChunk) {}

TailStore::~TailStore() {
  if (descriptor_ >= 0)
    ::close(descriptor_);
}

std::uint64_t TailStore::add(const char* data, std::size_t size) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (used_ + size > kChunk) {
    if (!chunks_.empty())
      spill();
    chunks_.emplace_back(new char[kChunk]);
    used_ = 0;
  }
  std::memcpy(chunks_.back().get() + used_, data, size);
  const std::uint64_t at = std::uint64_t(chunks_.size() - 1) * kChunk + used_;
  used_ += size;
  return at;
}

void TailStore::read(std::uint64_t at, char* out, std::size_t size) const {
  if (const char* chunk = chunks_[at / kChunk].get()) {
    std::memcpy(out, chunk + at % kChunk, size);
    return;
  }
  while (size > 0) {
    const ssize_t got = ::pread(descriptor_, out, size, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR)
      continue;
    if (got <= 0)
      fail("cannot read a temporary file back", got < 0 ? errno : EIO);
    out += got;
    at += static_cast<std::uint64_t>(got);
    size -= static_cast<std::size_t>(got);
  }
}

void TailStore::release(std::uint64_t end) {
  end -= end % kChunk;
  if (end <= released_)
    return;
  for (std::uint64_t at = released_; at < end; at += kChunk)
    chunks_[at / kChunk].reset();
#ifdef FALLOC_FL_PUNCH_HOLE
  if (descriptor_ >= 0)
    ::fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE,
                static_cast<off_t>(released_), static_cast<off_t>(end - released_));
#endif
  released_ = end;
}

void TailStore::open() {
  descriptor_ = createUnnamedFile(folder_);
  if (descriptor_ < 0)
    fail("cannot create a temporary file", errno);
}

// The last chunk is full. It stays in memory while few chunks do.
void TailStore::spill() {
  if (kept_ < maxChunks_) {
    ++kept_;
    return;
  }
  if (descriptor_ < 0)
    open();
  const std::uint64_t at = std::uint64_t(chunks_.size() - 1) * kChunk;
  if (!writeAllAt(descriptor_, at, chunks_.back().get(), kChunk))
    fail("cannot write a temporary file", errno);
  chunks_.back().reset();
}

void TailStore::fail(const char* what, int error) const {
  throw Error(Status::Write, folder_, std::string(what) + ": " + std::strerror(error),
              error == ENOSPC ? "free some space or write elsewhere; nothing was left behind"
                              : "write elsewhere");
}

} // namespace tetvdb
