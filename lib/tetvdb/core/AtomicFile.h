// SPDX-License-Identifier: Apache-2.0
//
// Files are whole or absent: written under a temporary name beside the target, synced, renamed.
//
//   tetvdb::AtomicFile file("out.vdb");
//   file.write(bytes, size);     // throws Error(Write) at once when the disk is full
//   file.commit();               // without it the destructor removes the temporary file
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace tetvdb {

/// One writer thread at a time.
class AtomicFile {
public:
  /// Creates the temporary file. Throws Error(Write) where that is not possible.
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends. Buffered; throws Error(Write) on failure.
  void write(const void* data, std::size_t size);
  /// Overwrites `size` bytes at `offset`, all of them written before; throws Error(Write).
  void writeAt(std::uint64_t offset, const void* data, std::size_t size);
  /// Bytes appended so far.
  std::uint64_t size() const noexcept { return size_; }
  const std::string& path() const noexcept { return path_; }

  /// Flushes, syncs and renames. Throws Error(Write); the target is then untouched.
  void commit();

private:
  void flush();
  [[noreturn]] void fail(const char* what, int error) const;

  std::string path_;
  std::string temporary_;
  std::string buffer_;
  std::uint64_t size_ = 0;
  int descriptor_ = -1;
};

/// Removes the temporary file of every AtomicFile that is open; async-signal-safe. For a program
/// that must end at once (a second Ctrl-C).
void removeTemporaryFiles() noexcept;

} // namespace tetvdb
