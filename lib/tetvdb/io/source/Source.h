// SPDX-License-Identifier: Apache-2.0
//
// The input of a reader: bytes with a name. A file is mapped; a fuzzer passes its own bytes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tetvdb {

struct Source {
  std::string_view bytes;
  std::string path; ///< for messages, and for files that name others beside them
  bool isMapped = false;

  /// Releases the memory of a mapped file that has been read; bytes that are read again come from
  /// the system's cache. Readers call it periodically; it has no effect for other bytes.
  void release() const noexcept;
};

/// Throws Error(Invalid): the file could not be opened, with this errno.
[[noreturn]] void failToOpen(const std::string& path, int error);

/// A file mapped read-only, or its bytes where it cannot be mapped (a pipe). A file that becomes
/// shorter while it is mapped raises SIGBUS where its missing bytes are read.
class MappedFile {
public:
  /// Throws Error(Invalid) for a missing, unreadable or empty file, a pointer of Git LFS, a
  /// directory or a device.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::string_view bytes() const noexcept { return {data_, size_}; }
  Source source() const { return {bytes(), path_, copy_.empty()}; }

private:
  std::string path_;
  std::string copy_;
  const char* data_ = nullptr;
  std::size_t size_ = 0;
};

} // namespace tetvdb
