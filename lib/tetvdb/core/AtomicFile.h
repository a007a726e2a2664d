// SPDX-License-Identifier: Apache-2.0
//
// Files are whole or absent: written without a name in the target's folder, synced, named, and
// renamed to the target. A program that is killed leaves nothing. On file systems that know no
// files without a name they have a temporary one from the beginning.
//
//   tetvdb::AtomicFile file("out.vdb");
//   file.write(bytes, size);     // throws Error(Write) at once when the disk is full
//   file.commit();               // without it the destructor removes the temporary file
//
// Only regular files are replaced: a pipe, a device, a socket, or a file that is this
// process's standard output gets the bytes at commit(), from a temporary file without a name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace tetvdb {

/// One writer thread at a time, any number that read back.
class AtomicFile {
public:
  /// Creates the temporary file, next to the file that `path` refers to: a symbolic link stays, and
  /// what it points to is replaced. Permissions are those of the file that is replaced, or of a new
  /// file. Throws Error(Write) where that is not possible: a folder, a file or folder that is
  /// write-protected. Opens no pipe or device yet.
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends. Buffered; throws Error(Write) on failure.
  void write(const void* data, std::size_t size);
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// Overwrites `size` bytes at `offset`, all of them written before; throws Error(Write).
  void writeAt(std::uint64_t offset, const void* data, std::size_t size);
  /// Hands what is buffered to the system; throws Error(Write).
  void flush();
  /// Reads `size` bytes at `offset` back, all of them written before the last flush(), from any
  /// thread, also while others are appended. Throws Error(Write).
  void readAt(std::uint64_t offset, void* data, std::size_t size) const;
  /// Bytes appended so far.
  std::uint64_t size() const noexcept { return size_; }
  const std::string& path() const noexcept { return path_; }

  /// A name of the temporary file for a library that writes it by itself, in place of write();
  /// commit() takes what is there then.
  std::string nameForLibraries();

  /// Flushes, syncs and renames, or sends the bytes to the pipe or device (waits for a pipe's
  /// reader). Throws Error(Write); a regular target is then untouched.
  void commit();

private:
  void createBeside(const std::string& target, bool exists);
  void send();
  void giveName();
  void replace();
  [[noreturn]] void fail(const char* what, int error) const;

  std::string path_;
  std::string target_;    ///< what is replaced, links followed; empty: bytes are sent to path_
  std::string temporary_; ///< empty: without a name as yet
  std::string buffer_;
  std::uint64_t size_ = 0;
  bool foreign_ = false; ///< written by name
  int descriptor_ = -1;
};

/// Removes the temporary file of every AtomicFile that is open; async-signal-safe. For a program
/// that must end at once (a second Ctrl-C).
void removeTemporaryFiles() noexcept;

} // namespace tetvdb
